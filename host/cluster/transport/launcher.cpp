#include "cluster/transport/launcher.h"

#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::transport {

namespace {

// The variables in which launchers tell a process the number of ranks, and its own. Slurm's are of a step: a
// batch script has others, though it is no rank.
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

constexpr Tag kPlace = kTagsOfCores.first, kShare = kPlace + 1;

struct Share {
  std::uint32_t index = 0, n = 1;
};

std::vector<int> allowed_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return cores;  // over 1024 cores
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

// Returns the machine and its cores as text, which is the same for ranks that share them.
Bytes place_of(const std::vector<int>& cores) {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) name[0] = '?';
  Bytes place = name.data();
  for (const int core : cores) place += "," + std::to_string(core);
  return place;
}

Share deal_out(Ranks& ranks, const Bytes& own) {
  std::map<Bytes, std::vector<int>> sharing;
  sharing[own].push_back(0);
  for (int n = 1; n < ranks.size(); ++n) {
    const Message message = ranks.wait(kTagsOfCores);
    sharing[message.bytes].push_back(message.from);
  }
  const auto n_of = [](const std::vector<int>& list) { return static_cast<std::uint32_t>(list.size()); };
  for (const auto& [place, list] : sharing)
    for (std::uint32_t i = 0; i < n_of(list); ++i) {
      if (list[i] == 0) continue;
      const Share share{i, n_of(list)};
      ranks.send(list[i], kShare, Bytes(reinterpret_cast<const char*>(&share), sizeof share));
    }
  return {0, n_of(sharing[own])};
}

Share ask_for_share(Ranks& ranks, const Bytes& own) {
  ranks.send(0, kPlace, own);
  const Message message = ranks.wait(kTagsOfCores);
  Share share;
  if (message.bytes.size() == sizeof share) std::memcpy(&share, message.bytes.data(), sizeof share);
  if (share.n == 0 || share.index >= share.n)
    throw Error(ErrorCode::internal, "rank 0 has dealt out no cores");
  return share;
}

}  // namespace

Launched launched() {
  for (const Variables& v : kLaunchers) {
    const int ranks = number(v.ranks), rank = number(v.rank);
    if (ranks > 0 && rank >= 0 && rank < ranks) return {ranks, rank, v.by};
  }
  return {};
}

std::vector<int> cores_of(const std::vector<int>& cores, std::size_t index, std::size_t n) {
  if (cores.size() < n) return cores;
  const auto at = [&](std::size_t i) {
    return cores.begin() + static_cast<std::ptrdiff_t>(i * cores.size() / n);
  };
  return {at(index), at(index + 1)};
}

void share_cores(Ranks& ranks) {
  const std::vector<int> all = allowed_cores();
  const Bytes place = place_of(all);
  const Share share = ranks.leads() ? deal_out(ranks, place) : ask_for_share(ranks, place);
  if (all.empty()) return;
  const std::vector<int> own = cores_of(all, share.index, share.n);
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : own) CPU_SET(static_cast<unsigned>(core), &set);
  if (own != all)
    ::sched_setaffinity(0, sizeof set, &set);  // where that is forbidden, threads are only fewer
  const std::size_t n_threads = all.size() < share.n ? 1 : own.size();
  ::setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(n_threads).c_str(), 0);
}

}  // namespace kdray::transport
