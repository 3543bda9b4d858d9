// Backgrounds by direction: pictures in each form that files have, and in none that readers may be made to
// trip over; what JSON scenes say of them.
#include "scene/textures/sky.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "base/error.h"
#include "io/image/exr.h"
#include "scene/import/load.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "support/seed.h"

namespace kdray::scene {
namespace {

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

std::shared_ptr<const SkyPicture> decode(const std::string& bytes) {
  std::vector<std::string> warnings;
  auto picture = decode_sky_picture(bytes, "p", warnings);
  EXPECT_TRUE(warnings.empty());
  return picture;
}

std::string refused(const std::string& bytes) {
  return test::refusal([&] {
    std::vector<std::string> warnings;
    decode_sky_picture(bytes, "p", warnings);
  });
}

const std::string kHead = "#?RADIANCE\nSOFTWARE=test\nFORMAT=32-bit_rle_rgbe\n";

std::string four(int a, int b, int c, int d) {
  return {static_cast<char>(a), static_cast<char>(b), static_cast<char>(c), static_cast<char>(d)};
}

TEST(Radiance, PlainPixels) {
  const auto p =
      decode(kHead + "\n-Y 1 +X 3\n" + four(128, 64, 32, 129) + four(255, 0, 1, 136) + four(9, 9, 9, 0));
  ASSERT_EQ(p->width, 3u);
  ASSERT_EQ(p->height, 1u);
  EXPECT_EQ(p->rgb, (std::vector<float>{1, 0.5f, 0.25f, 255, 0, 1, 0, 0, 0}));
  EXPECT_EQ(p->brightest, 255);
}

TEST(Radiance, AnExposureIsTakenBack) {
  const auto p = decode("#?RGBE\nEXPOSURE=4\nEXPOSURE= 0.5\n\n-Y 1 +X 1\n" + four(128, 128, 128, 129));
  EXPECT_EQ(p->rgb, (std::vector<float>{0.5f, 0.5f, 0.5f}));
}

// (1, 1, 1, n) repeats; the second such in a row counts 256 times as much.
TEST(Radiance, OldRuns) {
  const auto p = decode(kHead + "\n-Y 1 +X 264\n" + four(128, 0, 0, 129) + four(1, 1, 1, 6) +
                        four(1, 1, 1, 1) + four(0, 128, 0, 129));
  ASSERT_EQ(p->rgb.size(), 3u * 264);
  EXPECT_EQ(p->rgb[3 * 262], 1);
  EXPECT_EQ(p->rgb[3 * 263], 0);
  EXPECT_EQ(p->rgb[3 * 263 + 1], 1);
}

// As writers do it today: each of the four bytes for itself.
std::string coded_row(const std::vector<std::array<std::uint8_t, 4>>& row, std::mt19937& random) {
  std::string out = four(2, 2, static_cast<int>(row.size() >> 8), static_cast<int>(row.size() & 255));
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t x = 0; x < row.size();) {
      std::size_t same = 1;
      while (x + same < row.size() && same < 127 && row[x + same][c] == row[x][c]) ++same;
      if (same > 2) {
        out += static_cast<char>(128 + same), out += static_cast<char>(row[x][c]);
        x += same;
        continue;
      }
      const std::size_t n = std::min<std::size_t>(row.size() - x, 1 + random() % 128);
      out += static_cast<char>(n);
      for (std::size_t i = 0; i < n; ++i) out += static_cast<char>(row[x++][c]);
    }
  return out;
}

TEST(Radiance, CodedRows) {
  std::mt19937 random(9);
  std::string bytes = kHead + "\n-Y 7 +X 300\n";
  std::vector<float> wanted;
  for (int y = 0; y < 7; ++y) {
    std::vector<std::array<std::uint8_t, 4>> row(300);
    for (std::size_t x = 0; x < row.size(); ++x)
      for (std::size_t c = 0; c < 4; ++c)
        row[x][c] = random() % 4 && x > 0
                        ? row[x - 1][c]
                        : static_cast<std::uint8_t>(c == 3 ? 120 + random() % 20 : random());
    bytes += coded_row(row, random);
    for (const auto& pixel : row)
      for (std::size_t c = 0; c < 3; ++c)
        wanted.push_back(static_cast<float>(std::ldexp(pixel[c], pixel[3] - 136)));
  }
  EXPECT_EQ(decode(bytes)->rgb, wanted);
}

TEST(Radiance, SaysWhatIsWrong) {
  EXPECT_SAYS(refused("#?RADIANCE"), "p: is a damaged Radiance picture: it has no end of its header");
  EXPECT_SAYS(refused("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"), "32-bit_rle_xyze");
  EXPECT_SAYS(refused(kHead + "\n+X 1 -Y 1\nabcd"), "rows lie as '+X 1 -Y 1'");
  EXPECT_SAYS(refused(kHead + "\n-Y 0 +X 5\n"), "without pixels");
  EXPECT_SAYS(refused(kHead + "\n-Y 99999999 +X 99999999\n"), "99999999x99999999 pixels");
  EXPECT_SAYS(refused(kHead + "\n-Y 99999999999999999999999 +X 1\n"), "rows lie as");
  EXPECT_SAYS(refused(kHead + "\n-Y 2 +X 1\nabcd"), "is cut short");
  EXPECT_SAYS(refused(kHead + "\n-Y 1 +X 9\n" + four(2, 2, 0, 8)), "a row of another width");
  EXPECT_SAYS(refused(kHead + "\n-Y 1 +X 8\n" + four(2, 2, 0, 8) + "\x89z"), "a run beyond its row");
  EXPECT_SAYS(refused(kHead + "\n-Y 1 +X 2\n" + four(1, 1, 1, 1)), "repeats a pixel that isn't there");
  EXPECT_SAYS(refused("#?RGBE\nEXPOSURE=0\n\n-Y 1 +X 1\nabcd"), "an exposure");
  EXPECT_SAYS(refused("GIF89a"), "is neither EXR, Radiance HDR, PNG nor JPEG");
}

void expect_safe(const std::string& bytes) {
  try {
    std::vector<std::string> warnings;
    const auto picture = decode_sky_picture(bytes, "p", warnings);
    EXPECT_EQ(picture->rgb.size(), std::size_t{3} * picture->width * picture->height);
    for (const float v : picture->rgb) EXPECT_TRUE(std::isfinite(v) && v >= 0);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
  }
}

void mutate(const std::string& good, std::mt19937& random) {
  for (std::size_t n = 0; n < good.size(); ++n) expect_safe(good.substr(0, n));
  for (int round = 0; round < 3000; ++round) {
    std::string bad = good;
    for (unsigned i = 0; i <= random() % 4; ++i) bad[random() % bad.size()] = static_cast<char>(random());
    expect_safe(bad);
  }
}

TEST(Radiance, BrokenFilesAreRefusedOrRead) {
  const unsigned seed = test::seed_or(3);
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::string good = kHead + "\n-Y 3 +X 20\n";
  for (int y = 0; y < 3; ++y) {
    std::vector<std::array<std::uint8_t, 4>> row(20, {9, 8, 7, 130});
    row[5] = {1, 2, 3, 4};
    good += coded_row(row, random);
  }
  EXPECT_EQ(decode(good)->width, 20u);
  mutate(good, random);
}

TEST(SkyPicture, BrokenExrIsRefusedOrRead) {
  const unsigned seed = test::seed_or(4);
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  image::Image image;
  image.width = 9, image.height = 5;
  for (int i = 0; i < 45; ++i)
    image.pixels.emplace_back(static_cast<float>(random() % 9), 0.5f, static_cast<float>(i) / 7);
  mutate(image::encode_exr(image, {}), random);
}

TEST(SkyPicture, PngIsMadeLinear) {
  const auto p = decode(test::png(2, 1, 3, {255, 0, 188, 64, 128, 255}));
  const auto curve = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  const int codes[] = {255, 0, 188, 64, 128, 255};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(p->rgb[i], curve(codes[i] / 255.0), 1e-5);
}

TEST(SkyPicture, ExrAsItIsButForWhatIsNoLight) {
  image::Image image;
  image.width = 2, image.height = 1;
  image.pixels = {{1e4f, -1, 0.5f}, {std::numeric_limits<float>::infinity(), std::nanf(""), 2}};
  std::vector<std::string> warnings;
  const auto p = decode_sky_picture(image::encode_exr(image, {}), "p", warnings);
  EXPECT_EQ(p->rgb, (std::vector<float>{1e4f, 0, 0.5f, 0, 0, 2}));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_SAYS(warnings[0], "p: 3 values are below 0, infinite or no numbers");
}

TEST(SkyPicture, WhatIsNotTwiceAsWideAsHighIsToldOf) {
  const auto warnings_of = [](int width, int height) {
    image::Image image{width, height, {}};
    image.pixels.assign(static_cast<std::size_t>(width * height), vec3(1));
    std::vector<std::string> warnings;
    decode_sky_picture(image::encode_exr(image, {}), "p", warnings);
    return warnings;
  };
  EXPECT_TRUE(warnings_of(40, 20).empty());
  EXPECT_TRUE(warnings_of(41, 20).empty());
  EXPECT_TRUE(warnings_of(1, 8).empty()) << "colours by height";
  ASSERT_EQ(warnings_of(40, 40).size(), 1u);
  EXPECT_SAYS(warnings_of(40, 40)[0], "p: is 40x40; a picture all around is twice as wide as high");
}

// One that says that it is large is refused before it is read.
TEST(SkyPicture, ExrOfTooManyPixels) {
  image::Image image;
  image.width = 40, image.height = 30;
  image.pixels.assign(1200, vec3(1));
  const std::string bytes = image::encode_exr(image, {});
  EXPECT_SAYS(test::refusal([&] { image::decode_exr(bytes, "p", 1199); }), "40 x 30 pixels");
  EXPECT_EQ(image::decode_exr(bytes, "p", 1200).pixels.size(), 1200u);
}

TEST(SkyAxes, TurnRightHandedAboutUp) {
  const SkyAxes straight = axes_of({.kind = SkyKind::picture});
  EXPECT_NEAR(glm::length(straight.forward - dvec3(0, 0, -1)), 0, 1e-15);
  EXPECT_NEAR(glm::length(straight.right - dvec3(1, 0, 0)), 0, 1e-15);
  const SkyAxes quarter = axes_of({.kind = SkyKind::picture, .turn = std::acos(0.0)});
  EXPECT_NEAR(glm::length(quarter.forward - dvec3(-1, 0, 0)), 0, 1e-15);
  const SkyAxes lying = axes_of({.kind = SkyKind::picture, .up = {0, 0, 1}});
  EXPECT_NEAR(glm::length(lying.forward - dvec3(0, 1, 0)), 0, 1e-15);
}

class JsonSky : public testing::Test {
 protected:
  Scene read(const std::string& background) const {
    return read_json(R"({"background": )" + background + "}", folder_ / "s.json");
  }
  std::string refused(const std::string& background) const {
    return test::refusal([&] { read(background); });
  }
  test::ScratchFolder folder_;
};

TEST_F(JsonSky, Gradient) {
  const Scene s = read(R"({"type": "gradient", "up": [0, 0, 2], "stops": [
      {"height": -0.5, "color": 0.25}, {"height": 1, "color": [1, 2, 3]}]})");
  EXPECT_EQ(s.sky.kind, SkyKind::gradient);
  EXPECT_EQ(s.sky.up, dvec3(0, 0, 1));
  ASSERT_EQ(s.sky.stops.size(), 2u);
  EXPECT_EQ(s.sky.stops[1], (SkyStop{1, {1, 2, 3}}));
  EXPECT_EQ(s.sky.brightest, 3);
}

TEST_F(JsonSky, Picture) {
  folder_.write("sky.hdr", "#?RADIANCE\n\n-Y 1 +X 1\n" + four(128, 128, 128, 130));
  const Scene s = read(R"({"type": "picture", "file": "sky.hdr", "turn": 90, "strength": 3})");
  EXPECT_EQ(s.sky.kind, SkyKind::picture);
  EXPECT_NEAR(s.sky.turn, std::acos(0.0), 1e-15);
  EXPECT_EQ(s.sky.brightest, 6);
}

TEST_F(JsonSky, SaysWhatIsWrong) {
  EXPECT_SAYS(refused(R"({"type": "cube"})"), "/background/type: expected one of gradient, picture");
  EXPECT_SAYS(refused(R"({"type": "gradient", "stops": []})"), "/background: a gradient without stops");
  EXPECT_SAYS(
      refused(R"({"type": "gradient", "stops": [{"height": 0, "color": 1}, {"height": 0, "color": 1}]})"),
      "heights don't ascend");
  EXPECT_SAYS(refused(R"({"type": "gradient", "stops": [{"height": 2, "color": 1}]})"), "/height");
  EXPECT_SAYS(refused(R"({"type": "picture", "file": "none.hdr"})"), "none.hdr");
  EXPECT_SAYS(refused(R"({"type": "picture", "file": "none.hdr", "strenght": 1})"),
              "did you mean 'strength'");
}

TEST(JsonLights, WithAnArea) {
  const Scene s = read_json(R"({"lights": [
      {"type": "rectangle", "position": [1, 2, 3], "across": [2, 0, 0], "down": [0, 0, 4]},
      {"type": "sphere", "position": [0, 9, 0], "radius": 0.5, "color": 2, "range": 7},
      {"type": "disc", "position": [0, 9, 0], "normal": [0, -3, 0], "radius": 2,
       "attenuation": [1, 0, 1]}]})",
                            "s.json");
  ASSERT_EQ(s.lights.size(), 3u);
  EXPECT_EQ(s.lights[0].kind, LightKind::rectangle);
  EXPECT_EQ(s.lights[0].down, dvec3(0, 0, 4));
  EXPECT_EQ(s.lights[1].kind, LightKind::sphere);
  EXPECT_EQ(s.lights[1].radius, 0.5);
  EXPECT_EQ(s.lights[2].kind, LightKind::disc);
  EXPECT_NEAR(glm::length(s.lights[2].across), 2, 1e-15);
  EXPECT_NEAR(glm::length(s.lights[2].down), 2, 1e-15);
  EXPECT_NEAR(glm::dot(s.lights[2].across, s.lights[2].down), 0, 1e-15);
  EXPECT_NEAR(s.lights[2].across.y, 0, 1e-15);
  const auto refused_light = [](const std::string& light) {
    return test::refusal([&] { read_json(R"({"lights": [)" + light + "]}", "s.json"); });
  };
  EXPECT_SAYS(refused_light(R"({"type": "cube"})"),
              "one of point, directional, spot, rectangle, sphere, disc");
  EXPECT_SAYS(refused_light(R"({"type": "sphere", "position": [0, 0, 0], "radius": 0})"), "radius");
  EXPECT_SAYS(refused_light(
                  R"({"type": "rectangle", "position": [0, 0, 0], "across": [0, 0, 0], "down": [1, 0, 0]})"),
              "an edge of the light has no length");
}

TEST(JsonCamera, ALens) {
  const Scene s = read_json(
      R"({"camera": {"from": [0, 0, 0], "at": [0, 0, -3], "aperture": 0.2, "focus": 5}})", "s.json");
  EXPECT_EQ(s.camera->aperture, 0.2);
  EXPECT_EQ(s.camera->focus, 5);
  EXPECT_SAYS(test::refusal([] {
                read_json(R"({"camera": {"from": [0, 0, 0], "at": [0, 0, -3], "aperture": -1}})", "s.json");
              }),
              "aperture");
}

}  // namespace
}  // namespace kdray::scene
