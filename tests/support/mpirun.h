// What    Runs a program as several ranks, where Open MPI is installed.
// Shape   mpirun's own conditions are met here: that it may be root, that there may be more ranks than cores,
//         that no remote shell is there, and that a container may forbid one process to read another's
//         memory.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace kdray::test {

// Empty: there is none.
inline std::filesystem::path mpirun() {
  for (const char* const place : {"/usr/bin/mpirun", "/usr/local/bin/mpirun"})
    if (std::filesystem::exists(place)) return place;
  return {};
}

inline std::map<std::string, std::string> mpirun_environment() {
  return {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
          {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
          {"OMPI_MCA_rmaps_base_oversubscribe", "1"},
          {"PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"},  // the same for Open MPI 5
          {"OMPI_MCA_mpi_yield_when_idle", "1"},
          {"OMPI_MCA_plm_rsh_agent", ""},
          {"ASAN_OPTIONS", "detect_leaks=0:use_sigaltstack=0"},  // MPI leaves some behind
          {"OMPI_MCA_btl_vader_single_copy_mechanism", "none"}};
}

inline std::vector<std::string> mpirun_arguments(int ranks, const std::string& program,
                                                 const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"--bind-to", "none", "-n", std::to_string(ranks), program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

}  // namespace kdray::test
