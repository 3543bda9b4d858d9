// What    A picture on a plane as a whole frame shows it, against the same picture looked at in double where
//         each pixel's ray meets the plane; and what holes and veils let through, against what lies behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "pictures/render.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

constexpr int kSide = 64;
constexpr std::uint32_t kWidth = 9, kHeight = 6;

double curve(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

std::shared_ptr<scene::Picture> noise() {
  auto picture = std::make_shared<scene::Picture>(scene::blank_picture("noise", kWidth, kHeight));
  std::mt19937 random(64);
  for (std::uint8_t& byte : picture->texels) byte = static_cast<std::uint8_t>(random());
  return picture;
}

// The square from (-1, -1) to (1, 1) at this z, whose picture's upper left corner lies at (-1, 1).
void add_square(scene::Scene& s, double z, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& p : {dvec3{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}}) s.vertices.push_back(p);
  const float uv[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  for (const std::array<std::uint32_t, 3>& pick : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}}) {
    scene::Triangle t{.vertex = {first + pick[0], first + pick[1], first + pick[2]}};
    t.material = material;
    t.number = static_cast<std::uint32_t>(s.triangles.size());
    s.triangles.push_back(t);
    layout::TexCoords at{};
    for (std::size_t k = 0; k < 3; ++k) at.uv[k][0] = uv[pick[k]][0], at.uv[k][1] = uv[pick[k]][1];
    s.texturing.texcoords[0].push_back(at);
  }
}

// One that shines as its picture shows, seen straight from the front so that it fills the frame.
scene::Scene shining(const scene::Texture& texture, const scene::MaterialMaps& how) {
  scene::Scene s;
  s.texturing.pictures = {noise()};
  scene::MaterialMaps maps = how;
  maps.base = s.texturing.add(texture);
  maps.emission = vec3(1);
  s.materials = {scene::Material{}};
  s.materials[0].maps = s.texturing.add(maps);
  add_square(s, 0, 0);
  s.unlit = true;
  s.camera = scene::Camera{.from = {0, 0, 3}, .at = {0, 0, 0}, .up = {0, 1, 0}, .ortho_width = 2};
  return s;
}

// Red, green, blue and alpha about a place, in texels from the upper left corner; repeated.
std::array<double, 4> looked_up(const scene::Picture& p, double x, double y) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5), fx = x - 0.5 - left, fy = y - 0.5 - top;
  std::array<double, 4> sum{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto column = (static_cast<int>(left) + i + 100 * kWidth) % kWidth;
      const auto row = (static_cast<int>(top) + j + 100 * kHeight) % kHeight;
      for (std::size_t c = 0; c < 4; ++c) {
        const double code = p.texels[4 * (row * kWidth + column) + c] / 255.0;
        sum[c] += (c < 3 ? curve(code) : code) * (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
      }
    }
  return sum;
}

Picture rendered(const scene::Scene& model, int depth = 3) {
  Renderer renderer(Scene{scene::Scene(model)}, {}, device_of());
  return renderer.render(exact_options(kSide, kSide, depth));
}

// wanted(x, y) is the light at a pixel's middle, as shares of the frame from the upper left corner.
template <class Wanted>
void expect_picture(const Picture& got, const Wanted& wanted) {
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto light = wanted((x + 0.5) / kSide, (y + 0.5) / kSide);
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(got.rgb[3 * static_cast<std::size_t>(y * kSide + x) + c], light[c], 0.006)
            << x << ", " << y << ", " << c;
    }
}

TEST(Textures, APictureIsSeenTheRightWayUp) {
  const auto picture = noise();
  expect_picture(rendered(shining({}, {})),
                 [&](double x, double y) { return looked_up(*picture, kWidth * x, kHeight * y); });
}

TEST(Textures, APictureIsMovedAsItsTextureSays) {
  const auto picture = noise();
  const scene::Texture moved{.across = {1.5f, 0.5f, 0.125f}, .down = {-0.25f, 2, 0.75f}};
  expect_picture(rendered(shining(moved, {})), [&](double x, double y) {
    return looked_up(*picture, kWidth * (1.5 * x + 0.5 * y + 0.125), kHeight * (-0.25 * x + 2 * y + 0.75));
  });
}

TEST(Textures, AVeilLetsTheRestThrough) {
  scene::Scene s = shining({}, {.alpha = 0.75f, .mode = scene::Alpha::blend});
  s.background = {0.25f, 0.5f, 1};
  const auto picture = noise();
  expect_picture(rendered(s), [&](double x, double y) {
    const auto at = looked_up(*picture, kWidth * x, kHeight * y);
    const double alpha = 0.75 * at[3];
    return std::array{at[0] * alpha + 0.25 * (1 - alpha), at[1] * alpha + 0.5 * (1 - alpha),
                      at[2] * alpha + 1 - alpha};
  });
}

// A hole costs no depth, and shows what lies behind; the nearest texel decides, so that borders are sharp.
TEST(Textures, HolesShowWhatLiesBehind) {
  scene::Scene s = shining({.nearest = true}, {.cutoff = 0.5f, .mode = scene::Alpha::mask});
  s.materials.push_back({.emission = {0, 0, 2}});
  add_square(s, -1, 1);
  const auto picture = noise();
  expect_picture(rendered(s, 1), [&](double x, double y) {
    const auto column = static_cast<std::uint32_t>(kWidth * x), row = static_cast<std::uint32_t>(kHeight * y);
    const std::uint8_t* texel = picture->texels.data() + 4 * (row * kWidth + column);
    if (texel[3] < 127.5) return std::array{0.0, 0.0, 2.0};
    return std::array{curve(texel[0] / 255.0), curve(texel[1] / 255.0), curve(texel[2] / 255.0)};
  });
}

// A light behind the holes lights a wall through them, and nothing else of it.
TEST(Textures, ShadowsHaveHoles) {
  scene::Scene s = shining({.nearest = true}, {.cutoff = 0.5f, .mode = scene::Alpha::mask});
  s.texturing.material_maps[0].emission = vec3(0);
  s.materials.push_back({.diffuse = vec3(1)});
  add_square(s, -1, 1);
  s.lights = {{.kind = scene::LightKind::directional, .direction = {0, 0, -1}, .color = vec3(1)}};
  s.camera->from = {0, 0, -0.5};  // between the two, so that the wall alone is seen
  s.camera->at = {0, 0, -1};
  s.unlit = false;
  const auto picture = noise();
  expect_picture(rendered(s), [&](double x, double y) {
    const auto column = static_cast<std::uint32_t>(kWidth * x), row = static_cast<std::uint32_t>(kHeight * y);
    const double light = picture->texels[4 * (row * kWidth + column) + 3] < 127.5 ? 1 : 0;
    return std::array{light, light, light};
  });
}

}  // namespace
}  // namespace kdray::test
