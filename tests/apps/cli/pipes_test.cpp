// What    "-": scenes from standard input, and pictures, hits and scenes to standard output.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;

struct PipesTest : testing::Test {
  Folder folder;
  fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  Outcome piped(const std::vector<std::string>& arguments) const {
    return kdray(arguments, {.stdin_file = scene});
  }
};

TEST_F(PipesTest, APictureThatGoesToStdoutHasTheFilesBytes) {
  KDRAY_NEED_DEVICE();
  for (const char* const format : {"png", "exr"}) {
    const std::string file = folder / (std::string("a.") + format);
    ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", file})));
    const Outcome run = kdray({"render", scene, "-o", "-", "--format", format});
    ASSERT_TRUE(succeeds(run));
    EXPECT_EQ(run.out, folder.get(std::string("a.") + format));
    EXPECT_NE(run.err.find("Mrays/s"), std::string::npos) << run.err;
  }
  EXPECT_EQ(kdray({"render", scene, "-o", "-", "-q"}).out, folder.get("a.png"));
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "odd.name", "--format", "exr"})));
  EXPECT_EQ(folder.get("odd.name"), folder.get("a.exr"));
}

TEST_F(PipesTest, DevicesAndPipesNeedNoEnding) {
  KDRAY_NEED_DEVICE();
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.png"})));
  EXPECT_EQ(kdray({"render", scene, "-q", "-o", "/dev/stdout"}).out, folder.get("a.png"));
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = folder.get("pipe"); });
  const Outcome run = kdray({"render", scene, "-q", "-o", pipe});
  if (!run.exited || run.code != 0) std::ofstream(pipe) << "";  // lets the reader end
  reader.join();
  EXPECT_TRUE(succeeds(run));
  EXPECT_EQ(read, folder.get("a.png"));
  EXPECT_TRUE(fs::is_fifo(pipe)) << "the pipe was replaced by a file";
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", "/dev/null", "--aov", "depth"}), 2, "--format exr"));
  EXPECT_TRUE(succeeds(kdray({"render", scene, "-o", "/dev/null"})));
}

// Once, as a pipe can be: the cache doesn't look into it.
TEST_F(PipesTest, AScenesPipeIsReadOnce) {
  KDRAY_NEED_DEVICE();
  const fs::path pipe = folder / "scene.nff";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe) << std::ifstream(scene).rdbuf(); });
  const Outcome run = kdray({"render", pipe, "-q", "-o", folder / "b.png", "--cache", folder / "cache"});
  const int end = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);  // lets the writer go on where nobody has read
  writer.join();
  ::close(end);
  ASSERT_TRUE(succeeds(run));
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-q", "-o", folder / "a.png"})));
  EXPECT_EQ(folder.get("b.png"), folder.get("a.png"));
}

// A redirection that appends goes on where it was: the file is not replaced.
TEST_F(PipesTest, StdoutByAnyNameIsStdout) {
  for (const char* const name : {"-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"})
    EXPECT_TRUE(
        fails_with(kdray({"render", scene, "-o", name, "--stats", "-"}), 2, "both go to standard output"))
        << name;
}

TEST_F(PipesTest, AFolderIsToldWhatIsMeant) {
  fs::create_directory(folder / "film");
  for (const std::string name : {"film", "film/", "none/"})
    EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", folder / name}), 1,
                           "is a folder; name a picture in it, as in "))
        << name;
  EXPECT_TRUE(
      fails_with(kdray({"render", folder / "scene%02d.nff", "--frames", "0..3", "-o", folder / "film"}), 1,
                 "is a folder; name a picture in it"));
}

TEST_F(PipesTest, AnExrHoldsItsChannelsOnStdoutToo) {
  KDRAY_NEED_DEVICE();
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.exr", "--aov", "depth"})));
  EXPECT_EQ(kdray({"render", scene, "-o", "-", "--format", "exr", "--aov", "depth", "-q"}).out,
            folder.get("a.exr"));
  EXPECT_TRUE(fails_with(kdray({"render", scene, "-o", "-", "--aov", "depth"}), 2, "--format exr"));
}

TEST_F(PipesTest, ASceneFromStdinIsTheFiles) {
  KDRAY_NEED_DEVICE();
  ASSERT_TRUE(succeeds(kdray({"render", scene, "-o", folder / "a.png"})));
  const Outcome run = piped({"render", "-", "--scene-format", "nff", "-o", "-", "-q"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(run.out, folder.get("a.png"));
}

TEST_F(PipesTest, InfoReadsStdinToo) {
  const Outcome run = piped({"info", "-", "--scene-format", ".nff", "--json"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(nlohmann::json::parse(run.out)["primitives"]["total"], 3);
}

TEST_F(PipesTest, TheFormatOfStdinHasToBeSaid) {
  EXPECT_TRUE(fails_with(piped({"render", "-"}), 2, "--scene-format"));
  EXPECT_TRUE(fails_with(piped({"info", scene, "--scene-format", "nff"}), 2, "--scene-format"));
  EXPECT_TRUE(fails_with(piped({"info", "-", "--scene-format", "doc"}), 1, ".doc"));
  const fs::path bad = folder.put("bad", "b 0 0 0\ns 0 0 nan 1\n");
  const Outcome run = kdray({"info", "-", "--scene-format", "nff"}, {.stdin_file = bad});
  EXPECT_TRUE(fails_with(run, 1, "stdin.nff:2: "));
}

TEST_F(PipesTest, WhatStdoutIsNotFor) {
  const std::string picture = folder.put("a.png", "");
  EXPECT_TRUE(fails_with(kdray({"compare", picture, picture, "--diff", "-"}), 2, "standard output"));
  EXPECT_TRUE(fails_with(kdray({"compare", "-", picture}), 2, "compare reads files"));
  EXPECT_TRUE(fails_with(kdray({"tune", scene, "-o", "-"}), 2, "--output"));
}

}  // namespace
}  // namespace kdray::test
