// What    kdray warm-up through the real program: what it keeps serves every scene after it, without a
//         compiler and with the same picture.
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "support/data.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::size_t n_programs(const fs::path& folder) {
  std::size_t n = 0;
  for (const auto& entry : fs::directory_iterator(folder)) n += entry.path().extension() == ".program";
  return n;
}

std::size_t n_times(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

// Spheres and a cone, glass and mirror, a spot, a light with a range, and a sun before a coloured sky.
constexpr const char* kRich = R"({
  "camera": {"from": [0, 1, 6], "at": [0, 0, 0], "fov": 50}, "background": [0.2, 0.3, 0.4],
  "materials": {
    "glass": {"color": 0.9, "transmit": 0.8, "reflect": 0.1, "index": 1.5, "ks": 0.5, "shine": 30},
    "matt": {"color": [0.7, 0.5, 0.3]}},
  "lights": [
    {"type": "spot", "position": [2, 5, 3], "direction": [-2, -5, -3], "inner": 20, "outer": 40},
    {"type": "point", "position": [-3, 4, 2], "color": 0.6, "attenuation": [1, 0.1, 0.01], "range": 30},
    {"type": "directional", "direction": [0, -1, -0.3], "color": 0.4}],
  "objects": [
    {"type": "sphere", "center": [-1, 0, 0], "radius": 1, "material": "glass"},
    {"type": "cone", "base": [1.5, -1, 0], "apex": [1.5, 1, 0], "base_radius": 0.8, "apex_radius": 0,
     "material": "matt"}]
})";

class WarmUp : public testing::Test {
 protected:
  std::string programs() const { return folder_ / "cache/programs"; }

  // Renders or traces with and without what was warmed up.
  void expect_served(std::vector<std::string> arguments, const std::string& output) {
    SCOPED_TRACE(arguments.at(1));
    const std::size_t n = n_programs(programs());
    std::vector<std::string> warm = arguments, cold = std::move(arguments);
    warm.insert(warm.end(), {"-o", folder_ / ("warm" + output), "--cache", folder_ / "cache", "--stats",
                             folder_ / "s.json", "-v"});
    cold.insert(cold.end(), {"-o", folder_ / ("cold" + output), "--no-cache"});
    const Outcome run = kdray(warm);
    ASSERT_TRUE(succeeds(run));
    const Json programs_used = Json::parse(folder_.get("s.json")).at("programs");
    EXPECT_EQ(programs_used.at("compiled"), 0);
    EXPECT_EQ(programs_used.at("found"), 0);
    EXPECT_EQ(programs_used.at("covering"), 1);
    EXPECT_GT(programs_used.at("spare").size(), 0u);
    EXPECT_NE(run.err.find("kept from another scene"), std::string::npos) << run.err;
    EXPECT_EQ(n_programs(programs()), n);
    ASSERT_TRUE(succeeds(kdray(cold)));
    EXPECT_EQ(folder_.get("warm" + output), folder_.get("cold" + output));
  }

  const Folder folder_;
};

void put_rays(const fs::path& file) {
  const std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), }" + std::string(58, ' ') + "\n";
  std::ofstream out(file, std::ios::binary);
  out << std::string("\x93NUMPY\x01\x00", 8) << static_cast<char>(header.size()) << '\0' << header;
  const float rays[2][8] = {{-1, 0, 5, 0, 0, 0, -1, 100}, {5, 5, 5, 0, 0, 0, -1, 100}};
  out.write(reinterpret_cast<const char*>(rays), sizeof rays);
}

TEST_F(WarmUp, ServesWhatComesAfterIt) {
  KDRAY_NEED_DEVICE();
  const Outcome first = kdray({"warm-up", "--largest", "1M", "--cache", folder_ / "cache"});
  ASSERT_TRUE(succeeds(first));
  EXPECT_TRUE(first.out.empty());
  const std::size_t n = n_times(first.err, "compiled in ") - 1;  // the last line is the sum
  EXPECT_GE(n, 2u) << first.err;
  EXPECT_NE(first.err.find(std::to_string(n) + " of " + std::to_string(n) + " compiled"), std::string::npos)
      << first.err;
  EXPECT_GE(n_programs(programs()), n);

  const Outcome second = kdray({"warm-up", "--largest", "1M", "--cache", folder_ / "cache"});
  ASSERT_TRUE(succeeds(second));
  EXPECT_NE(second.err.find("0 of " + std::to_string(n) + " compiled"), std::string::npos) << second.err;
  EXPECT_EQ(n_times(second.err, "is there"), n) << second.err;
  const Outcome quiet = kdray({"warm-up", "-q", "--largest", "1M", "--cache", folder_ / "cache"});
  ASSERT_TRUE(succeeds(quiet));
  EXPECT_EQ(quiet.err, "");

  folder_.put("rich.json", kRich);
  ASSERT_TRUE(succeeds(kdray({"generate", "tetra", "--size", "4", "-o", folder_ / "tetra.nff"})));
  ASSERT_TRUE(succeeds(kdray({"generate", "balls", "--size", "2", "-o", folder_ / "balls.nff"})));
  put_rays(folder_ / "rays.npy");
  for (const char* const scene : {"rich.json", "tetra.nff", "balls.nff"})
    expect_served({"render", folder_ / scene, "--size", "40x30"}, ".png");
  expect_served({"render", folder_ / "rich.json", "--size", "40x30", "--samples", "4"}, ".png");
  expect_served({"render", folder_ / "balls.nff", "--size", "40x30", "--samples", "adaptive"}, ".png");
  expect_served({"trace", folder_ / "rich.json", "--rays", folder_ / "rays.npy"}, ".npy");
  expect_served({"trace", folder_ / "tetra.nff", "--rays", folder_ / "rays.npy", "--any-hit"}, ".npy");
}

// A program for each stage, each of which has to be there.
TEST_F(WarmUp, ServesTheScheduleOfGpusToo) {
  KDRAY_NEED_DEVICE();
  const std::vector<std::string> common = {"--schedule", "global", "--cache", folder_ / "cache"};
  std::vector<std::string> arguments = {"warm-up", "-q", "--largest", "1M"};
  arguments.insert(arguments.end(), common.begin(), common.end());
  ASSERT_TRUE(succeeds(kdray(arguments)));
  folder_.put("rich.json", kRich);
  arguments = {"render", folder_ / "rich.json", "--size",  "40x30",
               "-o",     folder_ / "a.png",     "--stats", folder_ / "s.json"};
  arguments.insert(arguments.end(), common.begin(), common.end());
  ASSERT_TRUE(succeeds(kdray(arguments)));
  const Json used = Json::parse(folder_.get("s.json")).at("programs");
  EXPECT_EQ(used.at("compiled"), 0) << used;
  EXPECT_GT(used.at("covering"), 1) << used;
}

TEST_F(WarmUp, NeedsAFolderThatItCanKeepProgramsIn) {
  KDRAY_NEED_DEVICE();
  EXPECT_TRUE(fails_with(kdray({"warm-up"}, {.environment = {{"KDRAY_CACHE_DIR", ""}}}), 2,
                         "no folder to keep programs in"));
  folder_.put("file", "a file, where a folder is wanted");
  EXPECT_TRUE(fails_with(kdray({"warm-up", "--cache", folder_ / "file"}), 1, "no program can be kept there"));
  EXPECT_TRUE(fails_with(kdray({"warm-up", "--device", "no such device", "--cache", folder_ / "cache"}), 3,
                         "no such device"));
  EXPECT_TRUE(fails_with(kdray({"warm-up", "scene.nff"}), 2, "scene.nff"));
}

}  // namespace
}  // namespace kdray::test
