// What    Backgrounds by direction as whole frames show them, seen directly, in mirrors and through glass,
//         against the oracle's in double.
#include <gtest/gtest.h>

#include <random>

#include "oracle/oracle.h"
#include "pictures/like_oracle.h"
#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr int kSize = 96;

void expect_like_oracle(const scene::Scene& model) {
  Renderer renderer(Scene{scene::Scene(model)}, {}, device_of());
  expect_like(renderer.render(exact_options(kSize, kSize)), oracle::trace_picture(model, kSize, kSize, 5));
}

scene::Scene with_sky(scene::Scene model, scene::Sky sky) {
  sky.brightest = scene::brightest_of(sky);
  model.sky = std::move(sky);
  return model;
}

std::shared_ptr<const scene::SkyPicture> noise(std::uint32_t width, std::uint32_t height) {
  scene::SkyPicture picture{"noise", width, height, {}};
  std::mt19937 random(width + height);
  for (std::uint32_t i = 0; i < 3 * width * height; ++i)
    picture.rgb.push_back(static_cast<float>(random() % 1000) / 1000.0f);
  picture.brightest = 1;
  return std::make_shared<const scene::SkyPicture>(std::move(picture));
}

// A camera that looks around, over the poles and the seam too.
scene::Scene nothing(const dvec3& at, const dvec3& up = {0, 1, 0}) {
  scene::Scene s;
  s.unlit = true;
  s.camera = scene::Camera{.from = {0, 0, 0}, .at = at, .up = up, .vertical_fov = 2};
  return s;
}

const dvec3 kWays[] = {{0, 0, -1}, {0, 0, 1}, {1, 0.2, 0}, {0.1, 1, 0.1}, {0, -1, 0.05}};

TEST(Sky, AGradientAllAround) {
  const scene::Sky sky{.kind = scene::SkyKind::gradient,
                       .up = glm::normalize(dvec3(0.3, 1, -0.2)),
                       .stops = {{-0.7, {0.1f, 0.2f, 0}}, {-0.1, {0.9f, 0.5f, 0.1f}}, {0.6, {0, 0.1f, 1}}}};
  for (const dvec3& way : kWays) expect_like_oracle(with_sky(nothing(way), sky));
}

TEST(Sky, APictureAllAround) {
  const scene::Sky sky{.kind = scene::SkyKind::picture,
                       .up = glm::normalize(dvec3(-0.2, 1, 0.1)),
                       .turn = 1.1,
                       .strength = 0.7,
                       .picture = noise(31, 17)};
  for (const dvec3& way : kWays) expect_like_oracle(with_sky(nothing(way), sky));
}

TEST(Sky, OfFewTexels) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 5u}, {2u, 1u}})
    expect_like_oracle(
        with_sky(nothing({0, 0.1, 1}), {.kind = scene::SkyKind::picture, .picture = noise(width, height)}));
}

// The top row is up, the middle column at -z, and what is right of it towards x.
TEST(Sky, APictureStandsUpright) {
  auto picture = std::make_shared<scene::SkyPicture>(scene::SkyPicture{"p", 64, 32, {}});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      picture->rgb.insert(picture->rgb.end(), {x >= 32 && x < 48 ? 1.0f : 0.0f, y < 16 ? 1.0f : 0.0f, 0.0f});
  picture->brightest = 1;
  Renderer renderer(
      Scene{with_sky(nothing({0, 0, -1}), {.kind = scene::SkyKind::picture, .picture = picture})}, {},
      device_of());
  const Picture seen = renderer.render(exact_options(4, 4));
  for (std::size_t y = 0; y < 4; ++y)
    for (std::size_t x = 0; x < 4; ++x) {
      EXPECT_FLOAT_EQ(seen.rgb[3 * (4 * y + x)], x >= 2 ? 1 : 0) << x << ", " << y;
      EXPECT_FLOAT_EQ(seen.rgb[3 * (4 * y + x) + 1], y < 2 ? 1 : 0) << x << ", " << y;
    }
}

TEST(Sky, InMirrorsAndGlass) {
  scene::Scene model = under_a_sky();
  model.camera->aperture = 0;
  expect_like_oracle(model);
  expect_like_oracle(with_sky(flat_glass(), {.kind = scene::SkyKind::gradient,
                                             .stops = {{-1, {1, 0, 0}}, {0, {0, 1, 0}}, {1, {0, 0, 1}}}}));
}

TEST(Sky, AColourTakesItsPlace) {
  const Scene scene{under_a_sky()};
  const PreparedScene prepared{scene};
  Renderer renderer(prepared.seen({.from = View::Vector{0, 50, 0},
                                   .at = View::Vector{0, 60, 0},
                                   .up = View::Vector{1, 0, 0},
                                   .background = std::array{0.25f, 0.5f, 1.0f}}),
                    device_of());
  const Picture seen = renderer.render(exact_options(3, 3));
  for (std::size_t i = 0; i < 9; ++i) EXPECT_FLOAT_EQ(seen.rgb[3 * i + 1], 0.5f);
}

}  // namespace
}  // namespace kdray::test
