// kill -9 of a random process (a run, a process that shares, a launcher or what it started) at a random time.
// After the picture was gone on with it has the bytes of one that was made in one go, and nothing hangs.
// KDRAY_KILL_SEEDS says how many seeds; each is told, and KDRAY_KILL_FIRST begins with another.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <thread>

#include "apps/cli/program.h"
#include "apps/cli/running.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

const fs::path kScene = fs::path(KDRAY_SOURCE_DIR) / "scenes/balls.nff";

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int number_in(const char* variable, int fallback) {
  const char* const text = std::getenv(variable);
  return text ? std::atoi(text) : fallback;
}

struct CheckpointKillTest : testing::Test {
  Folder folder;
  std::string log = folder / "log", checkpoint = folder / "checkpoint";
  std::mt19937 random;
  int n_killed = 0;
  double longest = 0;  // from the last kill to the end

  template <class Choices>
  auto one_of(const Choices& choices) {
    return *(std::begin(choices) + random() % std::size(choices));
  }
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }

  // What makes the picture's bits, and what only divides the work.
  const std::vector<Arguments> pictures = {{"--samples", "16", "--size", "300x200"},
                                           {"--samples", "adaptive:0.005", "--size", "280x220"}};
  const std::vector<Arguments> divisions = {{},
                                            {"--queues", "2"},
                                            {"--queues", "2", "--division", "contiguous"},
                                            {"--mode", "odprt", "--queues", "2"},
                                            {"--schedule", "global"}};

  Arguments command(const Arguments& picture, const std::string& output, const Arguments& more) {
    Arguments all{"render", kScene, "-q", "-o", output};
    for (const Arguments& part : {picture, one_of(divisions), more})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  std::string reference(const Arguments& picture) {
    static std::map<Arguments, std::string> known;
    std::string& bytes = known[picture];
    if (!bytes.empty()) return bytes;
    for (const Arguments& division : divisions) {  // which also warms the driver's cache
      Arguments all{"render", kScene, "-q", "-o", folder / "ref.png"};
      for (const Arguments& part : {picture, division}) all.insert(all.end(), part.begin(), part.end());
      EXPECT_TRUE(succeeds(kdray(all)));
    }
    return bytes = folder.get("ref.png");
  }

  // False: it had ended before.
  bool kill_after(double seconds, Running& run) {
    if (run.wait(seconds)) return false;
    run.kill(SIGKILL);
    ++n_killed;
    return true;
  }

  void expect_end(Running& run, Clock::time_point killed) {
    ASSERT_TRUE(run.wait()) << "it hangs";
    longest = std::max(longest, since(killed));
    EXPECT_EQ(run.code(), 0) << folder.get("log");
  }

  void kill_runs(const Arguments& picture);
  void kill_sharers(const Arguments& picture);
  void kill_launched(const Arguments& picture);
};

void CheckpointKillTest::kill_runs(const Arguments& picture) {
  const Arguments keep{"--checkpoint", checkpoint, "--resume", "--checkpoint-every", "0.02"};
  for (std::size_t n = 1 + random() % 3; n > 0; --n) {
    Running run(command(picture, folder / "a.png", keep), log);
    kill_after(between(0.05, 0.6), run);
    run.wait();
  }
  Running last(command(picture, folder / "a.png", keep), log);
  expect_end(last, Clock::now());
}

void CheckpointKillTest::kill_sharers(const Arguments& picture) {
  const auto more = [&] {
    return Arguments{"--share", checkpoint,           "--lease",
                     "1",       "--checkpoint-every", one_of(std::vector{"0.02", "1"})};
  };
  std::vector<Running> runs;
  const std::size_t n = 2 + random() % 2;
  for (std::size_t i = 0; i < n; ++i)
    runs.emplace_back(command(picture, folder / fmt::format("{}.png", i), more()), log);
  const std::size_t victim = random() % n;
  kill_after(between(0.05, 0.7), runs[victim]);
  const auto killed = Clock::now();
  if (random() % 2 == 0) runs.emplace_back(command(picture, folder / "late.png", more()), log);
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (i != victim) expect_end(runs[i], killed);
  runs[victim].wait();
  fs::copy_file(folder / fmt::format("{}.png", victim == 0 ? 1 : 0), folder / "a.png",
                fs::copy_options::overwrite_existing);
}

void CheckpointKillTest::kill_launched(const Arguments& picture) {
  const Arguments keep{"--checkpoint", checkpoint, "--resume", "--checkpoint-every", "0.02"};
  Arguments launched = keep;
  launched.insert(launched.end(), {"--restarts", "20"});
  Running launcher(command(picture, folder / "a.png", launched), log);
  for (std::size_t n = 1 + random() % 3; n > 0; --n) {
    if (launcher.wait(between(0.05, 0.5))) break;
    if (random() % 3 > 0) {
      for (const pid_t child : launcher.children()) ::kill(child, SIGKILL), ++n_killed;
      continue;
    }
    const std::vector<pid_t> children = launcher.children();
    launcher.kill(SIGKILL);
    ++n_killed;
    ASSERT_TRUE(launcher.wait());
    const auto killed = Clock::now();
    for (const pid_t child : children)
      EXPECT_TRUE(comes_true([&] { return ::kill(child, 0) != 0; })) << "what it started is still there";
    Running last(command(picture, folder / "a.png", keep), log);
    return expect_end(last, killed);
  }
  expect_end(launcher, Clock::now());
}

TEST_F(CheckpointKillTest, EveryPictureIsWhole) {
  KDRAY_NEED_DEVICE();
  const int first = number_in("KDRAY_KILL_FIRST", 1), n = number_in("KDRAY_KILL_SEEDS", 6);
  for (int seed = first; seed < first + n; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    random.seed(static_cast<unsigned>(seed));
    fs::remove_all(checkpoint);
    folder.put("log", "");
    for (const auto& entry : fs::directory_iterator(folder.path()))
      if (entry.path().extension() == ".png") fs::remove(entry.path());
    const Arguments& picture = pictures[random() % pictures.size()];
    const std::string whole = reference(picture);
    const auto way = {&CheckpointKillTest::kill_runs, &CheckpointKillTest::kill_sharers,
                      &CheckpointKillTest::kill_launched};
    (this->*way.begin()[seed % 3])(picture);
    ASSERT_TRUE(folder.get("a.png") == whole) << "another picture; " << folder.get("log");
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      const std::string name = entry.path().filename().string();
      if (!name.ends_with(".png") || name.starts_with("ref") || name.starts_with(".")) continue;
      EXPECT_TRUE(folder.get(name) == whole) << name;
    }
  }
  fmt::print("{} seeds from {} on: {} processes killed, {:.1f} s from a kill to the end at most\n", n, first,
             n_killed, longest);
  EXPECT_GT(n_killed, 0);
}

}  // namespace
}  // namespace kdray::test
