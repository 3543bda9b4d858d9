// What    kdray compare: differences that are known, its exit codes, its heat map.
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/cli/program.h"
#include "io/image/picture_file.h"
#include "support/folder.h"

namespace kdray::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// 10 x 10 of 0.25 grey; `changed` pixels are 0.75.
fs::path picture(const Folder& folder, const std::string& name, int changed, int height = 10) {
  image::Image image{10, height, std::vector<vec3>(static_cast<std::size_t>(10 * height), vec3(0.25f))};
  for (int i = 0; i < changed; ++i) image.pixels[static_cast<std::size_t>(i)] = vec3(0.75f);
  image::write_picture(folder / name, image, {}, {});
  return folder / name;
}

TEST(CompareCommand, KnownDifferences) {
  const Folder folder;
  const fs::path a = picture(folder, "a.exr", 0), b = picture(folder, "b.exr", 4);
  const Outcome run = kdray({"compare", a, b, "--json"});
  ASSERT_TRUE(succeeds(run));
  const Json d = Json::parse(run.out);
  EXPECT_NEAR(d["rmse"], 0.1, 1e-6);  // sqrt(0.04 * 0.5^2)
  EXPECT_NEAR(d["mean_absolute"], 0.02, 1e-6);
  EXPECT_NEAR(d["max"], 0.5, 1e-6);
  EXPECT_NEAR(d["differing_share"], 0.04, 1e-9);
  EXPECT_GT(d["flip"], 0.0);
}

TEST(CompareCommand, APictureDoesNotDifferFromItself) {
  const Folder folder;
  const fs::path a = picture(folder, "a.png", 7);
  const Outcome run = kdray({"compare", a, a});
  ASSERT_TRUE(succeeds(run));
  EXPECT_NE(run.out.find("RMSE            0\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("FLIP            0\n"), std::string::npos) << run.out;
  EXPECT_TRUE(succeeds(kdray({"compare", a, a, "--max-rmse", "0"})));
}

TEST(CompareCommand, TheLimitDecidesTheExitCode) {
  const Folder folder;
  const fs::path a = picture(folder, "a.exr", 0), b = picture(folder, "b.exr", 4);
  EXPECT_TRUE(succeeds(kdray({"compare", a, b, "--max-rmse", "0.11"})));
  const Outcome over = kdray({"compare", a, b, "--max-rmse", "0.09"});
  EXPECT_EQ(over.code, 1);
  EXPECT_NE(over.out.find("RMSE"), std::string::npos);
  EXPECT_NE(over.err.find("0.09"), std::string::npos) << over.err;
  EXPECT_TRUE(fails_with(kdray({"compare", a, b, "--max-rmse", "nan"}), 2, "--max-rmse"));
}

TEST(CompareCommand, AlphaIsTakenIntoAccount) {
  const Folder folder;
  const fs::path opaque = picture(folder, "a.png", 0);
  image::Image clear = image::read_picture(opaque, {});
  clear.alpha.assign(100, 1.0f);
  clear.alpha[7] = 0, clear.pixels[7] = vec3(0);
  image::write_picture(folder / "b.png", clear, {}, {});
  const Json d = Json::parse(kdray({"compare", opaque, folder / "b.png", "--json"}).out);
  EXPECT_EQ(d["max"], 1.0);
  EXPECT_EQ(d["differing_share"], 0.01);
}

TEST(CompareCommand, GammaChangesHowAPngIsRead) {
  const Folder folder;
  image::Image image{2, 1, {vec3(0), vec3(1)}};
  image::Image grey{2, 1, {vec3(0), vec3(0.5f)}};
  image::write_picture(folder / "a.png", image, {},
                       {.transfer = {.srgb = false, .gamma = 1}, .png_bits = 16});
  image::write_picture(folder / "b.png", grey, {}, {.transfer = {.srgb = false, .gamma = 1}, .png_bits = 16});
  const auto max = [&](const std::string& gamma) -> double {
    return Json::parse(
        kdray({"compare", folder / "a.png", folder / "b.png", "--json", "--gamma", gamma}).out)["max"];
  };
  EXPECT_NEAR(max("1"), 0.5, 1e-4);
  EXPECT_NEAR(max("2"), 0.75, 1e-4);
  EXPECT_NEAR(max("srgb"), 1 - std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-4);
}

TEST(CompareCommand, TheHeatMapShowsWhere) {
  const Folder folder;
  const fs::path a = picture(folder, "a.png", 0), b = picture(folder, "b.png", 1);
  ASSERT_TRUE(succeeds(kdray({"compare", a, b, "--diff", folder / "d.png"})));
  const image::Image map = image::read_picture(folder / "d.png", {});
  ASSERT_EQ(map.pixels.size(), 100u);
  EXPECT_GT(map.pixels[0].x + map.pixels[0].y, 0.5f);
  EXPECT_LT(map.pixels[50].x + map.pixels[50].y, 0.5f);
}

TEST(CompareCommand, Refusals) {
  const Folder folder;
  const fs::path a = picture(folder, "a.png", 0), flat = picture(folder, "b.png", 0, 9);
  const std::string before = folder.get("a.png");
  EXPECT_TRUE(fails_with(kdray({"compare", a, flat}), 1, "10x9"));
  EXPECT_TRUE(fails_with(kdray({"compare", a, folder / "none.png"}), 1, "none.png"));
  EXPECT_TRUE(fails_with(kdray({"compare", a, folder.put("text.png", "text")}), 1, "text.png"));
  EXPECT_TRUE(fails_with(kdray({"compare", a, a, "--diff", a}), 2, "same file"));
  EXPECT_TRUE(fails_with(kdray({"compare", a, a, "--diff", folder / "no/d.png"}), 1, "no"));
  EXPECT_EQ(folder.get("a.png"), before);
}

}  // namespace
}  // namespace kdray::test
