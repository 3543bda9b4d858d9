// The MPI transport between real processes, and what is said where it can't be opened.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "cluster/transport/mpi.h"
#include "support/mpirun.h"
#include "support/variable.h"

namespace kdray::test {
namespace {

struct Ended {
  int code = -1;
  std::string output;
};

Ended run(int ranks, const std::vector<std::string>& arguments, const std::string& more = {}) {
  std::string command = "env " + more;
  for (const auto& [name, value] : mpirun_environment()) command += " " + name + "=" + value;
  command += " timeout 120 " + mpirun().string();
  for (const std::string& argument : mpirun_arguments(ranks, KDRAY_MPI_RANK, arguments))
    command += " " + argument;
  std::FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  Ended result;
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) result.output.append(buffer, n);
  const int status = ::pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

struct MpiTest : testing::Test {
  void SetUp() override {
    if (mpirun().empty()) GTEST_SKIP() << "no mpirun (openmpi-bin)";
    if (std::string_view(KDRAY_MPI_PLUGIN).empty())
      GTEST_SKIP() << "libkdray-mpi.so was not built: no MPI was found";
  }
};

TEST_F(MpiTest, EveryMessageComesOnceAndWhole) {
  for (const int ranks : {1, 2, 4}) {
    const Ended all = run(ranks, {std::to_string(ranks), "exercise"}, "KDRAY_MPI_PLUGIN=" KDRAY_MPI_PLUGIN);
    EXPECT_EQ(all.code, 0) << all.output;
    for (int rank = 0; rank < ranks; ++rank)
      EXPECT_NE(all.output.find("rank " + std::to_string(rank) + ": well"), std::string::npos) << all.output;
  }
}

TEST_F(MpiTest, OneRankCanEndAll) {
  const Ended all = run(3, {"3", "abort"}, "KDRAY_MPI_PLUGIN=" KDRAY_MPI_PLUGIN);
  EXPECT_EQ(all.code, 7) << all.output;
}

TEST_F(MpiTest, WithoutThePluginThatIsSaid) {
  const Ended none = run(1, {"1", "exercise"}, "KDRAY_MPI_PLUGIN=/nowhere/libkdray-mpi.so");
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.output.find("no MPI: /nowhere/libkdray-mpi.so is not there; --mpi off"), std::string::npos)
      << none.output;
  // A library, but not this one.
  const Ended other = run(1, {"1", "exercise"}, "KDRAY_MPI_PLUGIN=libm.so.6");
  EXPECT_NE(other.output.find("is of another version of kdray"), std::string::npos) << other.output;
}

TEST(LauncherTest, IsToldByVariables) {
  const Variable none1("OMPI_COMM_WORLD_SIZE"), none2("PMI_SIZE"), none3("SLURM_STEP_NUM_TASKS");
  EXPECT_EQ(transport::launched().ranks, 0);
  const Variable of_batch("SLURM_NTASKS", "8");  // a batch script's own process is no rank
  EXPECT_EQ(transport::launched().ranks, 0);
  const Variable ranks("SLURM_STEP_NUM_TASKS", "8"), rank("SLURM_PROCID", "3");
  EXPECT_EQ(transport::launched().ranks, 8);
  EXPECT_EQ(transport::launched().rank, 3);
  EXPECT_EQ(transport::launched().by, "srun");
  const Variable damaged("SLURM_STEP_NUM_TASKS", "8x");
  EXPECT_EQ(transport::launched().ranks, 0);
  const Variable too_few("SLURM_STEP_NUM_TASKS", "3");
  EXPECT_EQ(transport::launched().ranks, 0);
}

}  // namespace
}  // namespace kdray::test
