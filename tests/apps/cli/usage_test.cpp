// What    Usage: help, versions, and what is refused before anything is done (exit code 2).
#include <sstream>

#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

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
  EXPECT_TRUE(run.out.starts_with("kdray " KDRAY_VERSION "\n")) << run.out;
  for (const char* const word : {"compiler", "OpenCL", "headers", "PoCL", "MPI", "reads", "JPEG"})
    EXPECT_NE(run.out.find(word), std::string::npos) << word << ": " << run.out;
  EXPECT_EQ(run.out.find(KDRAY_SOURCE_DIR), std::string::npos) << "not reproducible: " << run.out;
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

// What other renderers call it, and names that are nearly ours; but nothing where nothing is near.
TEST(Usage, SuggestionsDoNotMislead) {
  const auto told = [](const char* option) { return kdray({"render", "a.nff", option, "1"}).err; };
  for (const char* const option : {"--width", "--height", "--resolution", "-W"})
    EXPECT_NE(told(option).find("did you mean '--size WxH'?"), std::string::npos) << told(option);
  EXPECT_NE(told("--spp").find("did you mean '--samples'?"), std::string::npos);
  EXPECT_NE(told("--lookat").find("did you mean '--at'?"), std::string::npos);
  EXPECT_NE(told("--bg").find("did you mean '--background'?"), std::string::npos);
  EXPECT_NE(told("--gpu").find("did you mean '--device gpu'?"), std::string::npos);
  EXPECT_NE(told("--szie").find("did you mean '--size'?"), std::string::npos)
      << "two letters that changed places";
  EXPECT_NE(told("--backgr").find("did you mean '--background'?"), std::string::npos) << "a beginning";
  for (const char* const option : {"--exposure", "--wireframe", "--gi", "--config", "--shadow"})
    EXPECT_EQ(told(option).find("did you mean"), std::string::npos) << told(option);
  // Only what the command has.
  EXPECT_EQ(kdray({"info", "a.nff", "--width", "1"}).err.find("did you mean"), std::string::npos);
}

TEST(Usage, MisspeltValuesAreToldTheValue) {
  const auto told = [](const char* option, const char* value) {
    return kdray({"render", "a.nff", option, value});
  };
  EXPECT_TRUE(fails_with(told("--aov", "depht"), 2, "did you mean 'depth'?"));
  EXPECT_TRUE(fails_with(told("--aov", "depth,nromal"), 2, "did you mean 'normal'?"));
  EXPECT_TRUE(fails_with(told("--mode", "pdrt"), 2, "did you mean 'pdprt'?"));
  EXPECT_TRUE(fails_with(told("--build", "balance"), 2, "did you mean 'balanced'?"));
  EXPECT_TRUE(fails_with(told("--background", "skybleu"), 2, "did you mean 'skyblue'?"));
  EXPECT_EQ(told("--mode", "parallel").err.find("did you mean"), std::string::npos);
}

TEST(Usage, ASceneInPlaceOfACommandIsToldTheCommands) {
  EXPECT_TRUE(fails_with(kdray({"scene.glb"}), 2, "kdray render scene.glb, or kdray view scene.glb"));
  EXPECT_TRUE(fails_with(kdray({"dir/scan.PLY.gz", "-o", "a.png"}), 2, "kdray render dir/scan.PLY.gz, or"));
  EXPECT_TRUE(fails_with(kdray({"picture.png"}), 2, "there is no command"));
}

TEST(Usage, HelpOfACommandByItsName) {
  EXPECT_EQ(kdray({"help"}).out, kdray({"--help"}).out);
  for (const char* const command : {"render", "warm-up", "help"})
    EXPECT_EQ(kdray({"help", command}).out, kdray({command, "--help"}).out) << command;
  EXPECT_TRUE(fails_with(kdray({"help", "rendr"}), 2, "did you mean 'render'?"));
  if (!has_bench()) return;
  EXPECT_EQ(kdray({"help", "bench", "rays"}).out, kdray({"bench", "rays", "--help"}).out);
}

// The lines of help from a heading to the empty line after it.
std::string section(const std::string& help, const std::string& heading) {
  const std::size_t start = help.find("\n" + heading + ":\n");
  if (start == std::string::npos) return "";
  return help.substr(start, help.find("\n\n", start) - start);
}

TEST(Usage, HelpBeginsWithWhatMostPeopleNeed) {
  for (const char* const command : {"render", "view"}) {
    const std::string help = kdray({"help", command}).out, first = section(help, "Most used");
    for (const char* const option :
         {"--size ", "--samples ", "--from ", "--at ", "--up ", "--background ", "--device ", "--depth "})
      EXPECT_NE(first.find("\n  " + std::string(option)), std::string::npos) << option << first;
    std::size_t n_options = 0;
    for (std::size_t at = 0; (at = first.find("\n  -", at)) != std::string::npos; ++at) ++n_options;
    EXPECT_LE(n_options, 10u) << first;
    for (const char* const group :
         {"Scene", "Picture", "View", "Division", "Device", "Cache", "Tree", "General"})
      EXPECT_GT(help.find("\n" + std::string(group) + ":\n"), help.find(first)) << group;
  }
  EXPECT_NE(section(kdray({"help", "render"}).out, "Most used").find("-o, --output FILE"), std::string::npos);
}

TEST(Usage, HelpFitsOneHundredCharacters) {
  for (const std::string& command : kCommands) {
    if (command == "bench" && !has_bench()) continue;
    std::istringstream help(kdray({"help", command}).out);
    for (std::string line; std::getline(help, line);) EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST(Usage, ColoursAreTakenAsTheWebWritesThem) {
  KDRAY_NEED_DEVICE();
  Folder folder;
  const std::string scene = folder.put("ball.nff", kSphereOnSquare);
  const auto seen = [&](const std::string& color) {
    return kdray({"render", scene, "--size", "8x8", "-q", "-o", "-", "--background", color}).out;
  };
  EXPECT_FALSE(seen("#ff8800").empty());
  EXPECT_EQ(seen("#f80"), seen("#ff8800"));
  EXPECT_EQ(seen("skyblue"), seen("#87ceeb"));
  EXPECT_EQ(seen("white"), seen("1,1,1"));
  EXPECT_NE(seen("white"), seen("black"));
  EXPECT_TRUE(fails_with(kdray({"render", scene, "--background", "#ff88"}), 2, "#rrggbb"));
}

TEST(Usage, MissingAndSuperfluousArguments) {
  EXPECT_TRUE(fails_with(kdray({"render"}), 2, "SCENE"));
  EXPECT_TRUE(fails_with(kdray({"trace", "a.nff", "-o", "h.npy"}), 2, "--rays"));
  EXPECT_TRUE(fails_with(kdray({"trace", "a.nff", "--rays", "r.npy"}), 2, "--output"));
  EXPECT_TRUE(fails_with(kdray({"compare", "a.png"}), 2, "B"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "b.nff"}), 2, "b.nff"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--no-such-option"}), 2, "--no-such-option"));
  EXPECT_TRUE(fails_with(kdray({"render", "a.nff", "--size"}), 2, "--size"));
}

struct Refused {
  const char *option, *value, *wanted;
};

TEST(Usage, ValuesThatAreNoneAreRefusedWithWhatIsAccepted) {
  const Refused cases[] = {
      {"--size", "10x", "WIDTHxHEIGHT"},
      {"--size", "0x10", "WIDTHxHEIGHT"},
      {"--size", "10x", "WIDTHxHEIGHT"},
      {"--size", "-4x4", "WIDTHxHEIGHT"},
      {"--size", "4x4x4", "WIDTHxHEIGHT"},
      {"--size", "99999x1", "65536"},
      {"--size", "65536x65536", "pixels"},
      {"--crop", "10x10", "WIDTHxHEIGHT+X+Y"},
      {"--crop", "10x10+5", "WIDTHxHEIGHT+X+Y"},
      {"--crop", "0x10+5+5", "WIDTHxHEIGHT+X+Y"},
      {"--crop", "10x10+5+-5", "WIDTHxHEIGHT+X+Y"},
      {"--crop", "10+5x10+5", "WIDTHxHEIGHT+X+Y"},
      {"--depth", "0", "from 1 to 64"},
      {"--depth", "65", "from 1 to 64"},
      {"--depth", "5.5", "whole number"},
      {"--min-weight", "nan", "number"},
      {"--min-weight", "2", "from 0 to 1"},
      {"--samples", "adaptive:none", "RMSE"},
      {"--samples", "0", "from 1"},
      {"--samples", "70000", "from 1 to 65536"},
      {"--grid", "edges", "corners"},
      {"--mode", "both", "auto, pdprt, odprt"},
      {"--queues", "0", "from 1"},
      {"--traversal", "octree", "auto, binary, wide, packet, batch"},
      {"--precision", "half", "float, double"},
      {"--gamma", "0", "srgb"},
      {"--gamma", "warm", "srgb"},
      {"--exposure", "nan", "-100 to 100"},
      {"--bits", "12", "8, 16"},
      {"--aov", "depth,colour", "primitive"},
      {"--aov", "", "depth"},
      {"--tile", "8x", "WIDTHxHEIGHT"},
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
  EXPECT_TRUE(fails_with(kdray({"info", "a\nb\033[31m.nff"}), 1, "a?b?[31m.nff"));
  EXPECT_TRUE(fails_with(kdray({"tu\nne"}), 2, "tu ne"));
}

}  // namespace
}  // namespace kdray::test
