#include "cluster/transport/launcher.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

namespace kdray::transport {

namespace {

// How launchers tell a process of the number of ranks, and of its own. Slurm's are of a step: a batch script
// has others, though it is no rank.
struct Variables {
  const char *ranks, *rank, *by;
};
constexpr Variables kLaunchers[] = {{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "mpirun"},
                                    {"PMI_SIZE", "PMI_RANK", "mpirun"},
                                    {"SLURM_STEP_NUM_TASKS", "SLURM_PROCID", "srun"}};

int number(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return -1;
  const std::string_view text = value;
  int n = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error == std::errc() && end == text.data() + text.size() ? n : -1;
}

}  // namespace

Launched launched() {
  for (const Variables& v : kLaunchers) {
    const int ranks = number(v.ranks), rank = number(v.rank);
    if (ranks > 0 && rank >= 0 && rank < ranks) return {ranks, rank, v.by};
  }
  return {};
}

}  // namespace kdray::transport
