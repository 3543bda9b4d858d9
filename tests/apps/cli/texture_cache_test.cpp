// Pictures that lie in files look as they do in memory, in every mode, from the scene's file and from the
// scene cache.
#include <nlohmann/json.hpp>
#include <random>

#include "apps/cli/program.h"
#include "scene/pictures.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

constexpr int kSide = 640;  // 1.6 MB: more than what is kept in memory in any case

constexpr const char* kFloor = R"({
  "camera": {"from": [0, 2, 4], "at": [0, 0, 0]},
  "lights": [{"type": "point", "position": [3, 5, 4]}],
  "render": {"size": [96, 64]},
  "objects": [
    {"type": "triangles", "vertices": [[-5, 0, -20], [5, 0, -20], [5, 0, 3], [-5, 0, 3]], 
     "faces": [[0, 3, 2], [0, 2, 1]], "uv": [[0, 0], [3, 0], [3, 7], [0, 7]],
     "material": {"color": [1, 1, 1], "picture": "p.png"}}]})";

std::string noise() {
  std::mt19937 random(11);
  std::vector<std::uint16_t> samples(std::size_t{3} * kSide * kSide);
  for (auto& s : samples) s = static_cast<std::uint16_t>(random() % 256);
  return png(kSide, kSide, 3, samples);
}

std::uint64_t bytes_in_files(const Folder& folder) {
  const auto memory = nlohmann::json::parse(folder.get("s.json"))["memory"];
  return memory.contains("texture_file_bytes") ? memory["texture_file_bytes"].get<std::uint64_t>() : 0;
}

TEST(TextureCache, FilesGiveTheSamePicture) {
  KDRAY_NEED_DEVICE();
  const Folder folder;
  folder.put("p.png", noise());
  const auto scene = folder.put("floor.json", kFloor);
  const auto rendered = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words = {"render",         scene, "-q", "-o", folder / "a.exr", "--stats",
                                      folder / "s.json"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_TRUE(succeeds(kdray(words)));
    return folder.get("a.exr");
  };
  const std::string plain = rendered({"--no-cache"});
  EXPECT_EQ(bytes_in_files(folder), 0u);
  for (const char* const mode : {"pdprt", "odprt"}) {
    EXPECT_TRUE(rendered({"--no-cache", "--texture-cache", "0", "--mode", mode}) == plain) << mode;
    EXPECT_GT(bytes_in_files(folder), 4u * kSide * kSide) << mode;
  }
  const std::string cache = folder / "cache";
  for (const char* const time : {"first", "from the scene cache"}) {
    EXPECT_TRUE(rendered({"--cache", cache, "--texture-cache", "1M"}) == plain) << time;
    EXPECT_GT(bytes_in_files(folder), 4u * kSide * kSide) << time;
  }
  EXPECT_TRUE(rendered({"--cache", cache, "--texture-cache", "1G"}) == plain);
  EXPECT_EQ(bytes_in_files(folder), 0u);
}

TEST(TextureCache, OfNoNumberIsRefused) {
  const Folder folder;
  const Outcome run = kdray({"render", folder.put("floor.json", kFloor), "--texture-cache", "much"});
  EXPECT_EQ(run.code, 2);
  EXPECT_NE(run.err.find("--texture-cache"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace kdray::test
