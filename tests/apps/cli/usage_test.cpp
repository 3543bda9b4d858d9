// What    Usage: help, versions, and what is refused before anything is done (exit code 2).
#include "apps/cli/program.h"

namespace kdray::test {
namespace {

const std::vector<std::string> kCommands = {"render", "trace",  "tune",     "info",    "devices",
                                            "bench",  "doctor", "generate", "compare", "view"};

TEST(Usage, HelpNamesEveryCommand) {
  const Outcome run = kdray({"--help"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_TRUE(run.err.empty()) << run.err;
  for (const std::string& command : kCommands)
    EXPECT_NE(run.out.find("  " + command), std::string::npos) << command;
}

TEST(Usage, EveryCommandHasHelp) {
  for (const std::string& command : kCommands) {
    if (command == "bench" && !has_bench()) continue;
    const Outcome run = kdray({command, "--help"});
    EXPECT_TRUE(succeeds(run));
    EXPECT_NE(run.out.find("Usage: kdray " + command), std::string::npos) << run.out;
    EXPECT_TRUE(run.err.empty()) << run.err;
  }
}

TEST(Usage, VersionIsTheProjects) {
  const Outcome run = kdray({"--version"});
  ASSERT_TRUE(succeeds(run));
  EXPECT_EQ(run.out, "kdray " KDRAY_VERSION "\n");
}

TEST(Usage, UnknownCommandIsToldWhatThereIs) {
  for (const char* const command : {"look", "rendr", ""}) {
    const Outcome run = kdray({command, "x"});
    EXPECT_TRUE(fails_with(run, 2, "'" + std::string(command) + "'"));
    for (const std::string& known : kCommands) EXPECT_NE(run.err.find(known), std::string::npos) << run.err;
  }
  EXPECT_TRUE(fails_with(kdray({}), 2, "render, view, trace"));
}

TEST(Usage, WhatIsNearlyANameIsToldTheName) {
  EXPECT_TRUE(fails_with(kdray({"rendr", "x"}), 2, "did you mean 'render'?"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--sise=3x3"}), 2, "'--sise'; did you mean '--size'?"));
  EXPECT_TRUE(fails_with(kdray({"trace", "a.nff", "--ray", "r", "-o", "h"}), 2, "did you mean '--rays'?"));
  EXPECT_TRUE(fails_with(kdray({"bench", "ray"}), 2, "did you mean 'rays'?"));
  EXPECT_TRUE(fails_with(kdray({"bench", "rays", "--clases", "x"}), 2, "did you mean '--classes'?"));
}

TEST(Usage, MissingAndSuperfluousArguments) {
  EXPECT_TRUE(fails_with(kdray({"render"}), 2, "SCENE"));
  EXPECT_TRUE(fails_with(kdray({"trace", "a.nff", "-o", "h.npy"}), 2, "--rays"));
  EXPECT_TRUE(fails_with(kdray({"trace", "a.nff", "--rays", "r.npy"}), 2, "--output"));
  EXPECT_TRUE(fails_with(kdray({"compare", "a.png"}), 2, "B"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "b.nff"}), 2, "b.nff"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--no-such-option"}), 2, "--no-such-option"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--size"}), 2, "--size"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--depth", "3", "--depth", "4"}), 2, "--depth"));
}

struct Refused {
  const char *option, *value, *wanted;
};

TEST(Usage, ValuesThatAreNoneAreRefusedWithWhatIsAccepted) {
  const Refused cases[] = {
      {"--size", "10", "WIDTHxHEIGHT"},
      {"--size", "0x10", "WIDTHxHEIGHT"},
      {"--size", "10x", "WIDTHxHEIGHT"},
      {"--size", "-4x4", "WIDTHxHEIGHT"},
      {"--size", "4x4x4", "WIDTHxHEIGHT"},
      {"--size", "99999x1", "65536"},
      {"--size", "65536x65536", "pixels"},
      {"--depth", "0", "from 1 to 64"},
      {"--depth", "65", "from 1 to 64"},
      {"--depth", "5.5", "whole number"},
      {"--min-weight", "nan", "number"},
      {"--min-weight", "2", "from 0 to 1"},
      {"--samples", "adaptive:none", "RMSE"},
      {"--samples", "0", "from 1"},
      {"--grid", "edges", "corners"},
      {"--mode", "both", "auto, pdprt, odprt"},
      {"--queues", "0", "from 1"},
      {"--traversal", "octree", "auto, binary, wide, packet, batch"},
      {"--precision", "half", "float, double"},
      {"--gamma", "0", "srgb"},
      {"--gamma", "warm", "srgb"},
      {"--bits", "12", "8, 16"},
      {"--aov", "depth,colour", "primitive"},
      {"--aov", "", "depth"},
      {"--tile", "8", "WIDTHxHEIGHT"},
      {"--work-group", "-1", "from 1"},
      {"--tree-depth", "-2", "from 0"},
      {"--cost-traverse", "x", "number"},
      {"--cost-intersect", "0", "from"},
      {"--device", "", "auto"},
  };
  for (const Refused& c : cases) {
    const Outcome run = kdray({"render", "no-such-scene.nff", c.option, c.value});
    EXPECT_TRUE(fails_with(run, 2, c.wanted)) << c.option << " " << c.value;
    EXPECT_NE(run.err.find(c.option), std::string::npos) << run.err;
  }
}

TEST(Usage, MessagesStayOnOneLineWhateverTheNames) {
  EXPECT_TRUE(fails_with(kdray({"info", "a\nb\033[31m.nff"}), 1, "a b [31m.nff"));
  EXPECT_TRUE(fails_with(kdray({"tu\nne"}), 2, "tu ne"));
}

}  // namespace
}  // namespace kdray::test
