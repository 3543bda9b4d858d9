// What    kdray generate: files, stdout, and that the other commands read what it writes.
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const std::vector<std::string> kNames = {"balls",  "gears", "mount", "rings",
                                         "teapot", "tetra", "tree",  "lattice"};

TEST(GenerateCommand, AFileHoldsWhatStdoutGets) {
  const Folder folder;
  const Outcome printed = kdray({"generate", "tetra", "--size", "2"});
  ASSERT_TRUE(succeeds(printed));
  ASSERT_TRUE(succeeds(kdray({"generate", "tetra", "--size", "2", "-o", folder / "t.nff"})));
  EXPECT_EQ(folder.get("t.nff"), printed.out);
  EXPECT_NE(printed.out.find("\np 3"), std::string::npos);
  EXPECT_EQ(folder.n_entries(), 1u);
}

TEST(GenerateCommand, EveryContractSceneIsReadBack) {
  const Folder folder;
  for (const std::string& name : kNames) {
    const fs::path file = folder / (name + ".nff");
    ASSERT_TRUE(succeeds(kdray({"generate", name, "--size", "1", "-o", file}))) << name;
    const Outcome info = kdray({"info", file, "--json"});
    ASSERT_TRUE(succeeds(info)) << name;
    EXPECT_GT(Json::parse(info.out)["primitives"]["total"], 3) << name;
  }
}

TEST(GenerateCommand, AGeneratedSceneRenders) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "1", "-o", folder / "b.nff"})));
  ASSERT_TRUE(succeeds(kdray({"render", folder / "b.nff", "--size", "24x24", "-o", folder / "b.png"})));
  EXPECT_EQ(folder.get("b.png").substr(1, 3), "PNG");
}

TEST(GenerateCommand, WithoutASizeItIsHaines) {
  const Folder folder;
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "-o", folder / "b.nff"})));
  const Json info = Json::parse(kdray({"info", folder / "b.nff", "--json"}).out);
  EXPECT_EQ(info["primitives"]["spheres"], 7381);
}

TEST(GenerateCommand, HelpListsTheScenes) {
  const Outcome run = kdray({"generate", "--help"});
  for (const std::string& name : kNames)
    EXPECT_NE(run.out.find("  " + name + " "), std::string::npos) << name;
}

TEST(GenerateCommand, Refusals) {
  const Folder folder;
  const Outcome unknown = kdray({"generate", "spheres", "-o", folder / "a.nff"});
  EXPECT_TRUE(fails_with(unknown, 2, "balls"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "--size", "1000", "-o", folder / "a.nff"}), 2, "1000"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "--size", "two"}), 2, "--size"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "-o", folder / "no/a.nff"}), 1, "no"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "-o", folder / "a.nff.gz"}), 1, ".gz"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "-o", folder / "a.png"}), 1, "end the name in .nff"));
  EXPECT_TRUE(fails_with(kdray({"generate", "balls", "-o", folder / "a"}), 1, "end the name in .nff"));
  EXPECT_EQ(folder.n_entries(), 0u);
}

TEST(GenerateCommand, AFullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_TRUE(
      fails_with(kdray({"generate", "tetra", "--size", "3"}, {.stdout_file = "/dev/full"}), 1, "written"));
  EXPECT_TRUE(fails_with(kdray({"generate", "tetra", "--size", "3", "-o", "/dev/full"}), 1, "/dev/full"));
  EXPECT_TRUE(fails_with(kdray({"--help"}, {.stdout_file = "/dev/full"}), 1, "standard output"));
}

}  // namespace
}  // namespace kdray::test
