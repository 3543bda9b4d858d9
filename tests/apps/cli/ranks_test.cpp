// What    mpirun kdray render: pictures of any number of ranks and queues have the bytes of one process's;
//         one rank speaks; a rank that fails ends the job with one line; a checkpoint goes on with other
//         ranks.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "apps/cli/program.h"
#include "apps/cli/ranks.h"
#include "apps/cli/running.h"
#include "apps/cli/scenes.h"
#include "cluster/partition/ply_files.h"
#include "cluster/transport/mpi.h"
#include "support/folder.h"
#include "support/mpirun.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

std::vector<std::string> lines_of_kdray(const std::string& err) {
  std::vector<std::string> lines;
  std::istringstream stream(err);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("kdray:") && line.find("compiling kernels") == std::string::npos)
      lines.push_back(line);
  return lines;
}

struct MpirunTest : testing::Test {
  Folder folder;
  std::string picture = folder / "a.png", stats = folder / "a.json";

  void SetUp() override {
    if (mpirun().empty()) GTEST_SKIP() << "no mpirun (openmpi-bin)";
    if (std::string_view(KDRAY_MPI_PLUGIN).empty())
      GTEST_SKIP() << "libkdray-mpi.so was not built: no MPI was found";
    if (!has_device()) GTEST_SKIP() << "no usable OpenCL device";
  }

  // Folders of its own for caches that all ranks see.
  Outcome ranks(int n, const Arguments& arguments,
                std::map<std::string, std::string> environment = {}) const {
    RunOptions options;
    options.program = mpirun();
    options.environment = mpirun_environment();
    options.environment["KDRAY_MPI_PLUGIN"] = KDRAY_MPI_PLUGIN;
    options.environment.merge(environment);
    return kdray(mpirun_arguments(n, KDRAY_PROGRAM, arguments), options);
  }

  Arguments render(const std::string& scene, const Arguments& more) const {
    Arguments arguments{"render", scene, "-o", picture, "--stats", stats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  std::string alone(const std::string& scene, const Arguments& more) {
    EXPECT_TRUE(succeeds(kdray(render(scene, more))));
    return folder.get("a.png");
  }

  std::string together(int n, const std::string& scene, const Arguments& more) {
    fs::remove(picture);
    const Outcome run = ranks(n, render(scene, more));
    EXPECT_TRUE(succeeds(run));
    EXPECT_LE(lines_of_kdray(run.err).size(), 3u) << run.err;
    return folder.get("a.png");
  }

  static Arguments with(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  nlohmann::json told() const { return nlohmann::json::parse(folder.get("a.json")); }
};

// The SPD scenes, small.
TEST_F(MpirunTest, PicturesAreTheSameForAnyNumberOfRanks) {
  const std::vector<std::string> scenes = {"balls", "gears", "mount", "rings", "teapot", "tetra", "tree"};
  const std::vector<std::pair<int, std::string>> ways = {{2, "1"}, {3, "2"}, {4, "1"}, {7, "1"},
                                                         {1, "2"}, {4, "2"}, {2, "2"}};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::string scene = folder / (scenes[i] + ".nff");
    ASSERT_TRUE(succeeds(kdray({"generate", scenes[i], "--size", "2", "-o", scene})));
    const Arguments size{"--size", "180x140"};
    const std::string whole = alone(scene, size);
    const auto rays = told()["rays"]["total"];
    const auto& [n, queues] = ways[i];
    SCOPED_TRACE(scenes[i] + ": " + std::to_string(n) + " ranks of " + queues);
    EXPECT_EQ(together(n, scene, {"--size", "180x140", "--queues", queues, "--mpi", "on"}), whole);
    EXPECT_EQ(told()["rays"]["total"], rays);
    EXPECT_EQ(told()["mode"]["per_queue"].size(), static_cast<std::size_t>(n) * std::stoul(queues));
    EXPECT_EQ(told()["mode"]["ranks"]["number"], n);
    EXPECT_EQ(together(n, scene, {"--size", "180x140", "--queues", queues, "--mpi", "on", "--mode", "odprt"}),
              whole);
    EXPECT_EQ(told()["rays"]["total"], rays);
    EXPECT_EQ(told()["mode"]["parts"], n * std::stoi(queues));
  }
}

TEST_F(MpirunTest, TheSceneDividedWithChannelsAndACheckpoint) {
  const std::string scene = folder / "balls.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "3", "-o", scene})));
  const Arguments sampled{"--size", "120x90", "--samples", "adaptive:0.02", "--mode", "odprt"};
  const std::string whole = alone(scene, sampled), checkpoint = folder / "checkpoint";
  Arguments kept = sampled;
  kept.insert(kept.end(), {"--checkpoint", checkpoint, "--resume", "--checkpoint-every", "0.05"});
  EXPECT_EQ(together(3, scene, kept), whole);
  EXPECT_EQ(together(2, scene, kept), whole);
  EXPECT_EQ(told()["ledger"]["rendered"], 0);
  EXPECT_EQ(together(2, scene, {"--size", "120x90", "--mode", "odprt", "--aov", "depth,normal"}),
            alone(scene, {"--size", "120x90", "--aov", "depth,normal"}));
}

// No rank holds all of it: neither of a file that is read in shares, nor of one that is read whole and kept
// in shares.
TEST_F(MpirunTest, SharesOfTheScene) {
  const std::string ply =
      folder.put("ball.ply", ball_ply(40, {.normals = true, .colors = true}, true)).string();
  const std::string nff = folder / "gears.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "gears", "--size", "2", "-o", nff})));
  const Arguments view{"--size", "150x110", "--look", "plain"};
  for (const std::string& scene : {ply, nff}) {
    const std::string whole = alone(scene, view);
    const auto rays = told()["rays"]["total"];
    for (const auto& [n, queues] : {std::pair(1, "2"), {2, "1"}, {3, "2"}, {4, "1"}, {7, "1"}}) {
      SCOPED_TRACE(scene + ": " + std::to_string(n) + " ranks of " + queues);
      EXPECT_EQ(
          together(n, scene,
                   with(view, {"--mode", "odprt", "--hold", "shares", "--mpi", "on", "--queues", queues})),
          whole);
      EXPECT_EQ(told()["mode"]["ranks"]["scene"], "shares");
      EXPECT_EQ(told()["mode"]["ranks"]["peak_bytes"].size(), static_cast<std::size_t>(n));
      EXPECT_EQ(told()["rays"]["total"], rays);
    }
  }
}

// One process begins a checkpoint with the whole scene, ranks go on from it with shares, and the other way
// round.
TEST_F(MpirunTest, CheckpointsOfSharesAndOfWholeScenes) {
  const std::string scene = folder.put("ball.ply", ball_ply(30, {.colors = true})).string();
  const Arguments size{"--size", "200x150", "--samples", "4", "--look", "plain"};
  const std::string whole = alone(scene, size), checkpoint = folder / "checkpoint";
  const Arguments kept = with(size, {"--checkpoint", checkpoint, "--resume", "--checkpoint-every", "0.05"});
  const Arguments in_shares = with(kept, {"--mode", "odprt", "--hold", "shares"});
  const auto lose_some = [&] {
    for (const auto& entry : fs::directory_iterator(checkpoint))
      if (entry.path().extension() == ".tiles")
        fs::resize_file(entry.path(), fs::file_size(entry.path()) * 2 / 5);
  };
  EXPECT_EQ(alone(scene, kept), whole);
  for (const int n : {3, 2, 5}) {
    lose_some();
    EXPECT_EQ(together(n, scene, in_shares), whole);
    EXPECT_EQ(told()["mode"]["ranks"]["scene"], "shares");
    EXPECT_GT(told()["ledger"]["found"], 0);
    EXPECT_GT(told()["ledger"]["rendered"], 0);
  }
  lose_some();
  EXPECT_EQ(alone(scene, kept), whole);
  EXPECT_GT(told()["ledger"]["found"], 0);
  EXPECT_EQ(together(3, scene, in_shares), whole);
  EXPECT_EQ(told()["ledger"]["rendered"], 0);
  const std::string other = folder.put("other.ply", ball_ply(31, {.colors = true})).string();
  const Outcome refused = ranks(2, render(other, in_shares));
  EXPECT_NE(refused.code, 0);
  EXPECT_EQ(lines_of_kdray(refused.err).size(), 1u) << refused.err;
}

// What needs the whole scene on each rank says so.
TEST_F(MpirunTest, WhatIsNotInShares) {
  const std::string scene = folder.put("ball.ply", ball_ply(20, {})).string();
  const Arguments size{"--size", "60x50"};
  const auto shares_of = [&](const Arguments& more) {
    const Outcome run =
        ranks(2, render(scene, with(with(size, {"--mode", "odprt", "--hold", "shares"}), more)));
    EXPECT_TRUE(succeeds(run));
    EXPECT_EQ(folder.get("a.png"), alone(scene, with(size, more)));
    return run.err;
  };
  for (const Arguments& more : {Arguments{"--aov", "depth"}, Arguments{"--background", "transparent"}})
    EXPECT_NE(shares_of(more).find("every rank holds the whole scene: "), std::string::npos) << more[0];
  // A small file's ranks have all of it.
  together(2, scene, with(size, {"--mode", "odprt"}));
  EXPECT_EQ(told()["mode"]["ranks"]["scene"], "whole");
}

TEST_F(MpirunTest, AdaptiveSamplingSequencesAndCaches) {
  const std::string scene = folder.put("ball.nff", kSphereOnSquare);
  const std::string whole = alone(scene, {"--size", "200x150", "--samples", "adaptive:0.01"});
  EXPECT_EQ(
      together(3, scene, {"--size", "200x150", "--samples", "adaptive:0.01", "--cache", folder / "cache"}),
      whole);
  folder.put("path.json", R"({"kdray_camera_path": 1, "interpolation": "linear", "keys": [
    {"frame": 0, "from": [0, -6, 3], "at": [0, 0, 1], "up": [0, 0, 1], "fov": 40},
    {"frame": 2, "from": [2, -6, 5], "at": [0, 0, 0], "up": [0, 0, 1], "fov": 30}]})");
  const auto frames = [&](const std::string& to) {
    return Arguments{"render", scene,      "-o",   folder / to,     "--size",
                     "100x80", "--frames", "0..2", "--camera-path", folder / "path.json"};
  };
  const Outcome run = ranks(2, frames("b%d.png"));
  if (run.code == 0) {
    ASSERT_TRUE(succeeds(kdray(frames("c%d.png"))));
    for (const char* const n : {"0", "1", "2"})
      EXPECT_EQ(folder.get(std::string("b") + n + ".png"), folder.get(std::string("c") + n + ".png"));
  } else {
    ADD_FAILURE() << run.err;
  }
}

TEST_F(MpirunTest, ACheckpointGoesOnWithOtherRanks) {
  const std::string scene = folder.put("ball.nff", kSphereOnSquare);
  const Arguments size{"--size", "300x200", "--samples", "4"};
  const std::string whole = alone(scene, size), checkpoint = folder / "checkpoint";
  const Arguments kept{"--size",   "300x200",  "--samples",          "4",   "--checkpoint",
                       checkpoint, "--resume", "--checkpoint-every", "0.05"};
  EXPECT_EQ(together(3, scene, kept), whole);
  EXPECT_EQ(told()["ledger"]["found"], 0);
  for (const auto& entry : fs::directory_iterator(checkpoint))
    if (entry.path().extension() == ".tiles")
      fs::resize_file(entry.path(), fs::file_size(entry.path()) * 2 / 5);
  EXPECT_EQ(together(2, scene, kept), whole);
  EXPECT_GT(told()["ledger"]["found"], 0);
  EXPECT_GT(told()["ledger"]["rendered"], 0);
  EXPECT_EQ(alone(scene, kept), whole);
  EXPECT_EQ(told()["ledger"]["rendered"], 0);
  EXPECT_EQ(together(2, scene, {"--size", "300x200", "--samples", "4", "--share", folder / "shared"}), whole);
}

TEST_F(MpirunTest, ARankThatFailsEndsTheJobInOneLine) {
  const std::string scene = folder.put("ball.nff", kSphereOnSquare);
  const auto line_of = [&](int n, const Arguments& arguments) {
    const Outcome run = ranks(n, arguments);
    const auto lines = lines_of_kdray(run.err);
    EXPECT_NE(run.code, 0);
    EXPECT_TRUE(run.exited);
    EXPECT_EQ(lines.size(), 1u) << run.err;
    return lines.empty() ? std::string() : lines.front();
  };
  const Arguments failing = render(scene, {"--size", "90x60", "--inject-fault", "1/self-test@0"});
  EXPECT_NE(line_of(3, failing).find("kdray: rank 1: "), std::string::npos);
  EXPECT_FALSE(fs::exists(picture));
  EXPECT_NE(line_of(3, render(folder / "none.nff", {})).find("none.nff"), std::string::npos);
  EXPECT_NE(line_of(3, render(scene, {"--sise", "9x9"})).find("did you mean"), std::string::npos);
  EXPECT_NE(line_of(3, render(scene, {"--mode", "odprt", "--inject-fault", "1/0@1"})).find("kdray: rank 1: "),
            std::string::npos);
  EXPECT_NE(line_of(2, render(scene, {"--mode", "odprt", "--device-memory", "200M"})).find("take more ranks"),
            std::string::npos);
  EXPECT_NE(line_of(2, render(scene, {"--trace", folder / "t.json"})).find("--trace"), std::string::npos);
  EXPECT_NE(line_of(2, render(scene, {"--checkpoint", folder / "l", "--restarts", "2"})).find("--restarts"),
            std::string::npos);
}

// KDRAY_KILL_SEEDS: how many times.
TEST_F(MpirunTest, WhateverRankIsKilledTheNextRunGoesOn) {
  const std::string scene = folder / "balls.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "2", "-o", scene})));
  const Arguments size{"--size", "400x300", "--samples", "16", "--cache", folder / "cache"};
  const std::string whole = alone(scene, size);
  const char* const asked = std::getenv("KDRAY_KILL_SEEDS");
  const unsigned seeds = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 3;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto pick = [&](int lo, int hi) { return std::uniform_int_distribution(lo, hi)(random); };
    fs::remove_all(folder / "checkpoint");
    Arguments kept = size;
    kept.insert(kept.end(), {"--checkpoint", folder / "checkpoint", "--resume", "--checkpoint-every", "0.1",
                             "--mode", pick(0, 1) == 0 ? "pdprt" : "odprt"});
    {
      auto environment = mpirun_environment();
      environment["KDRAY_MPI_PLUGIN"] = KDRAY_MPI_PLUGIN;
      Running run(mpirun_arguments(3, KDRAY_PROGRAM, render(scene, kept)), folder / "log", mpirun(),
                  environment);
      std::this_thread::sleep_for(std::chrono::milliseconds(pick(300, 1800)));
      const std::vector<pid_t> ranks = run.children();
      const int victim = pick(0, 3);
      if (victim == 3 || ranks.size() < 3)
        run.kill(SIGKILL);
      else
        ::kill(ranks[static_cast<std::size_t>(victim)], SIGKILL);
      EXPECT_TRUE(run.wait()) << "it hangs";
    }
    EXPECT_EQ(together(pick(1, 4), scene, kept), whole);
  }
}

// As measurements have it: later, and a few kilobytes after each other.
TEST_F(MpirunTest, ASlowNetworkGivesTheSameBytes) {
  const std::string scene = folder / "balls.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "2", "-o", scene})));
  const Arguments size{"--size", "100x80"};
  const std::string whole = alone(scene, size);
  for (const std::string mode : {"pdprt", "odprt"}) {
    fs::remove(picture);
    EXPECT_TRUE(succeeds(ranks(3, render(scene, with(size, {"--mode", mode})),
                               {{"KDRAY_MPI_DELAY", "2"}, {"KDRAY_MPI_BANDWIDTH", "0.1"}})));
    EXPECT_EQ(folder.get("a.png"), whole) << mode;
  }
  const Outcome refused = ranks(2, render(scene, size), {{"KDRAY_MPI_BANDWIDTH", "much"}});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("KDRAY_MPI_BANDWIDTH"), std::string::npos) << refused.err;
}

TEST_F(MpirunTest, WithoutMpiEachWorksByItself) {
  const std::string scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = ranks(2, render(scene, {"--mpi", "off", "--size", "50x40"}));
  EXPECT_TRUE(succeeds(run));
  EXPECT_EQ(lines_of_kdray(run.err).size(), 2u) << run.err;
  const Outcome none = ranks(2, render(scene, {}), {});
  EXPECT_TRUE(succeeds(none));
}

TEST(RankCores, AreDealtOutOnce) {
  const std::vector<int> cores{2, 3, 8, 9, 10};
  for (std::size_t n = 1; n <= cores.size(); ++n) {
    std::vector<int> all;
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<int> own = transport::cores_of(cores, i, n);
      EXPECT_GE(own.size(), cores.size() / n);
      all.insert(all.end(), own.begin(), own.end());
    }
    EXPECT_EQ(all, cores);
  }
  EXPECT_EQ(transport::cores_of(cores, 5, 6), cores);  // too few: all share all
}

TEST(RankFaults, AreOfOneRankOrOfAll) {
  EXPECT_EQ(cli::faults_of_rank("1/0@3,0@5,self-test@0", 0), "0@5,self-test@0");
  EXPECT_EQ(cli::faults_of_rank("1/0@3,0@5:bug", 1), "0@3,0@5:bug");
  EXPECT_EQ(cli::faults_of_rank("", 1), "");
}

}  // namespace
}  // namespace kdray::test
