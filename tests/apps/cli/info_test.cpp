// What    kdray info: the figures of a scene whose figures are known; without any device.
#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/cli/info_report.h"
#include "apps/cli/program.h"
#include "apps/cli/scenes.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// An empty folder for drivers: OpenCL's loader finds no platform.
RunOptions no_device(const Folder& folder) {
  fs::create_directory(folder / "vendors");
  return {.environment = {{"OCL_ICD_VENDORS", (folder / "vendors").string() + "/"}}};
}

TEST(InfoCommand, CountsBoundsAndMaterialsWithoutADevice) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"info", scene, "--json"}, no_device(folder));
  ASSERT_TRUE(succeeds(run));
  const Json info = Json::parse(run.out);
  EXPECT_EQ(info["primitives"]["total"], 3);
  EXPECT_EQ(info["primitives"]["triangles"], 2);
  EXPECT_EQ(info["primitives"]["spheres"], 1);
  EXPECT_EQ(info["primitives"]["dropped_degenerate"], 0);
  EXPECT_EQ(info["bounds"]["min"], Json({-4.0, -4.0, 0.0}));
  EXPECT_EQ(info["bounds"]["max"], Json({4.0, 4.0, 2.0}));
  EXPECT_EQ(info["lights"].size(), 1u);
  ASSERT_EQ(info["materials"].size(), 2u);
  EXPECT_EQ(info["materials"][0]["primitives"], 2);
  EXPECT_EQ(info["materials"][1]["primitives"], 1);
  EXPECT_NEAR(info["camera"]["vertical_fov_degrees"], 40, 1e-9);
  EXPECT_EQ(info["camera"]["made_up"], false);
  EXPECT_EQ(info["lights_made_up"], false);
}

TEST(InfoCommand, NamesMaterialsAndParts) {
  const Folder folder;
  const fs::path scene = folder.put(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no \x1b[31mCube\nusemtl brass\nf 1 2 3\nf 1 2 3\no Lid\nf 1 2 3\n");
  const Json info = Json::parse(kdray({"info", scene, "--json"}, no_device(folder)).out);
  EXPECT_EQ(info["materials"][0]["name"], "brass");
  EXPECT_EQ(info["parts"],
            Json({{{"name", "?[31mCube"}, {"primitives", 2}}, {{"name", "Lid"}, {"primitives", 1}}}));
  const std::string text = kdray({"info", scene}, no_device(folder)).out;
  EXPECT_NE(text.find("0: 'brass', 3 primitives"), std::string::npos) << text;
  EXPECT_NE(text.find("'?[31mCube', 2 primitives"), std::string::npos) << text;
  EXPECT_NE(text.find("camera       none: pictures show it in a studio"), std::string::npos) << text;
  EXPECT_EQ(text.find("directional"), std::string::npos) << "nobody made these lights: " << text;
  EXPECT_EQ(info["camera"]["made_up"], true);
}

TEST(InfoCommand, TextHasTheFirstPartsAndTheNumberOfAll) {
  scene::Scene scene;
  scene::NameTable table;
  for (std::uint32_t i = 0; i < 100; ++i) table.name_primitives(3 * i, table.add(fmt::format("part {}", i)));
  scene.names = table.finish(300, 0);
  const cli::Parts parts = cli::parts_report(scene, 12);
  EXPECT_EQ(parts.count, 100u);
  ASSERT_EQ(parts.first.size(), 12u);
  EXPECT_EQ(parts.first[11], (cli::Json{{"name", "part 11"}, {"primitives", 3}}));

  const Folder folder;
  std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 100; ++i) obj += fmt::format("o part {}\nf 1 2 3\n", i);
  const fs::path file = folder.put("parts.obj", obj);
  EXPECT_EQ(Json::parse(kdray({"info", file, "--json"}, no_device(folder)).out)["parts"].size(), 100u);
  const std::string text = kdray({"info", file}, no_device(folder)).out;
  EXPECT_NE(text.find("parts        100\n"), std::string::npos) << text;
  EXPECT_NE(text.find("'part 11', 1 primitives\n             and 88 more"), std::string::npos) << text;
}

TEST(InfoCommand, RunsOfNamesThatThereAreNotAreLeftOut) {
  scene::Scene scene;
  scene.names = std::make_shared<const scene::Names>(
      scene::Names{.texts = "lid",
                   .ends = {0, 3},
                   .materials = {},
                   .primitives = {{0, 1}, {2, 0x7fffffff}, {5, 2}, {6, 0}},
                   .instances = {{0, 0xffffffff}, {1, 0}}});
  const cli::Parts parts = cli::parts_report(scene, 12);
  EXPECT_EQ(parts.first, (cli::Json::array({{{"name", "lid"}, {"primitives", 2}}})));
}

// | `balls.nff` | 2 triangles, 820 spheres | 2 | 3 | (-12, -12, -0.5) to (12, 12, 0.821994) |
TEST(InfoCommand, TellsWhatTheDataSheetOfTheScenesSays) {
  const Folder folder;
  const fs::path scenes = fs::path(KDRAY_SOURCE_DIR) / "scenes";
  std::ifstream sheet(scenes / "README.md");
  int n_scenes = 0;
  for (std::string line; std::getline(sheet, line);) {
    std::vector<std::string> cells;
    for (std::size_t at = 0, end; (end = line.find(" | ", at)) != std::string::npos; at = end + 3)
      cells.push_back(line.substr(at, end - at));
    if (cells.size() != 4 || !cells[0].starts_with("| `")) continue;
    const std::string bounds = line.substr(line.rfind(" | ") + 3, line.rfind(" |") - line.rfind(" | ") - 3);
    const std::string told =
        kdray({"info", scenes / cells[0].substr(3, cells[0].size() - 4)}, no_device(folder)).out;
    SCOPED_TRACE(line + "\n" + told);
    EXPECT_NE(told.find(": " + cells[1] + "\n"), std::string::npos);
    EXPECT_NE(told.find("\nmaterials    " + cells[2] + "\n"), std::string::npos);
    EXPECT_NE(told.find("\nlights       " + cells[3] + "\n"), std::string::npos);
    EXPECT_NE(told.find("\nbounds       " + bounds + "\n"), std::string::npos);
    ++n_scenes;
  }
  EXPECT_GE(n_scenes, 12);
}

TEST(InfoCommand, TheTreesFiguresAgreeWithEachOther) {
  const Folder folder;
  const fs::path scene = folder / "b.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "2", "-o", scene})));
  const Json info = Json::parse(kdray({"info", scene, "--json"}).out);
  const Json& tree = info["tree"];
  EXPECT_EQ(tree["leaves"].get<int>(), tree["inner_nodes"].get<int>() + 1);
  EXPECT_EQ(tree["nodes"].get<int>(), tree["inner_nodes"].get<int>() + tree["leaves"].get<int>());
  int leaves = 0;
  for (const Json& count : tree["leaves_by_size"]) leaves += count.get<int>();
  EXPECT_EQ(leaves, tree["leaves"]);
  EXPECT_GE(tree["duplication"], 1.0);
  EXPECT_GT(tree["sah_cost"], 0.0);
  EXPECT_GT(info["memory"]["tree_bytes"], 8 * tree["nodes"].get<int>());
}

TEST(InfoCommand, MemoryIsThatOfItsArrays) {
  const Folder folder;
  const fs::path scene = folder / "b.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "3", "-o", scene})));
  const Json info = Json::parse(kdray({"info", scene, "--json"}).out);
  const Json& memory = info["memory"];
  for (const char* const part : {"scene", "geometry", "tree", "flat", "wide"}) {
    std::uint64_t sum = 0;
    for (const Json& array : memory["arrays"][part]) sum += array.get<std::uint64_t>();
    EXPECT_EQ(memory[std::string(part) + "_bytes"], sum) << part;
    EXPECT_GT(sum, 0u) << part;
  }
  EXPECT_EQ(memory["final_bytes"], memory["flat_bytes"].get<int>() + memory["wide_bytes"].get<int>());
  EXPECT_EQ(memory["arrays"]["flat"]["references"], 4 * info["tree"]["references"].get<int>());
  EXPECT_EQ(memory["arrays"]["flat"]["nodes"], 8 * info["tree"]["nodes"].get<int>());
  EXPECT_GT(memory["process_peak_bytes"], memory["final_bytes"]);
  if (!memory["build_peak_bytes"].is_null()) {
    EXPECT_GT(memory["build_peak_bytes"], 0);
    EXPECT_LE(memory["build_peak_bytes"], memory["process_peak_bytes"]);
  }
}

TEST(InfoCommand, TreeOptionsChangeTheTree) {
  const Folder folder;
  const fs::path scene = folder / "b.nff";
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "3", "-o", scene})));
  const auto depth = [&](const std::vector<std::string>& more) -> int {
    std::vector<std::string> arguments = {"info", scene, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Json::parse(kdray(arguments).out)["tree"]["max_depth"];
  };
  EXPECT_EQ(depth({"--tree-depth", "0"}), 0);
  EXPECT_EQ(depth({"--tree-depth", "3"}), 3);
  EXPECT_GT(depth({}), 3);
  for (const char* const quality : {"fast", "balanced", "best"}) {
    EXPECT_GT(depth({"--build", quality}), 3);
    EXPECT_EQ(Json::parse(kdray({"info", scene, "--json", "--build", quality}).out)["tree"]["build"],
              quality);
  }
  EXPECT_TRUE(fails_with(kdray({"info", scene, "--build", "slow"}), 2, "fast, balanced, best"));
  // Nothing is worth a split when tests cost nothing beside nodes.
  EXPECT_EQ(depth({"--cost-traverse", "1000000", "--cost-intersect", "0.000001"}), 0);
}

TEST(InfoCommand, TextHasThoseFiguresForPeople) {
  const Folder folder;
  const fs::path scene = folder.put("ball.nff", kSphereOnSquare);
  const Outcome run = kdray({"info", scene});
  ASSERT_TRUE(succeeds(run));
  for (const char* const text :
       {"3: 2 triangles, 1 spheres", "(-4, -4, 0) to (4, 4, 2)", "40 degrees", "SAH cost", "materials",
        "memory", "built balanced", "on the device", "sphere blocks", "at most"})
    EXPECT_NE(run.out.find(text), std::string::npos) << text << " in " << run.out;
}

TEST(InfoCommand, AnEmptySceneIsToldAsSuch) {
  const Folder folder;
  const fs::path scene = folder.put("none.nff", "b 0 0 0\n");
  const Outcome run = kdray({"info", scene, "--json"});
  if (run.code == 0) {
    EXPECT_TRUE(Json::parse(run.out)["bounds"].is_null());
  } else {
    EXPECT_TRUE(fails_with(run, 1, "none.nff"));
  }
  EXPECT_EQ(kdray({"info", scene}).code, run.code);
}

std::string sheet(int n) {
  std::string obj;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) obj += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1;
      obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + n + 2) + "\n";
      obj +=
          "f " + std::to_string(a) + " " + std::to_string(a + n + 2) + " " + std::to_string(a + n + 1) + "\n";
    }
  return obj;
}

TEST(InfoCommand, TheTreeIsMadeToFitTheMemoryWithAWarningAsInRender) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  const std::string scene = folder.put("sheet.obj", sheet(60));
  const auto bytes_of = [](const Outcome& run) {
    return nlohmann::json::parse(run.out)["memory"]["final_bytes"].get<std::uint64_t>();
  };
  const std::string least =
      std::to_string(bytes_of(kdray({"info", scene, "--json", "--memory", "100m"})) * 23 / 25);
  const Outcome coarse = kdray({"info", scene, "--json", "--memory", least});
  ASSERT_TRUE(succeeds(coarse));
  EXPECT_LE(bytes_of(coarse), std::stoull(least));
  EXPECT_NE(coarse.err.find("the tree is coarser"), std::string::npos) << coarse.err;
  EXPECT_TRUE(fails_with(kdray({"info", scene, "--memory", "1K"}), 4, "too little"));
  const std::string picture = folder / "a.png";
  const Outcome render = kdray({"render", scene, "-o", picture, "--size", "16x16", "--memory", least});
  ASSERT_TRUE(succeeds(render));
  EXPECT_NE(render.err.find("the tree is coarser"), std::string::npos) << render.err;
  const Outcome quiet = kdray({"render", scene, "-o", picture, "--size", "16x16", "--memory", least, "-q"});
  EXPECT_EQ(quiet.err, "");
}

}  // namespace
}  // namespace kdray::test
