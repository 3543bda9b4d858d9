// What    A chessboard that reaches far away, each pixel against the exact mean of what it covers; and the
//         same in a mirror and through a pane, whose rays bring their cones along.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "oracle/build_scene.h"
#include "pictures/render.h"
#include "scene/model/scene.h"

namespace kdray::test {
namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr double kHalfHeight = 0.4;  // of the picture, at distance 1
constexpr double kFar = -4000;

// Fields of a length of 1, black and white, 16 texels each.
std::shared_ptr<const scene::Picture> chessboard() {
  scene::Picture p = scene::blank_picture("chessboard", 32, 32);
  std::uint8_t* to = p.texels.data();
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto v = static_cast<std::uint8_t>((x / 16 + y / 16) % 2 == 0 ? 255 : 0);
      for (const std::uint8_t byte : {v, v, v, std::uint8_t{255}}) *to++ = byte;
    }
  return std::make_shared<const scene::Picture>(std::move(p));
}

void add_quad(scene::Scene& s, const std::array<dvec3, 4>& corners, std::uint32_t material) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& p : corners) s.vertices.push_back(p);
  for (const std::array<std::uint32_t, 3>& pick : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}}) {
    scene::Triangle t{.vertex = {first + pick[0], first + pick[1], first + pick[2]}};
    t.material = material;
    t.number = static_cast<std::uint32_t>(s.triangles.size());
    s.triangles.push_back(t);
    layout::TexCoords at{};
    for (std::size_t k = 0; k < 3; ++k) {
      at.uv[k][0] = static_cast<float>(corners[pick[k]].x / 2);
      at.uv[k][1] = static_cast<float>(corners[pick[k]].z / 2);
    }
    s.texturing.texcoords[0].push_back(at);
  }
}

// The floor y = 0 from the plane z = 0 on, seen from a height of 1 along -z.
scene::Scene floor_of(scene::Minify minify) {
  scene::Scene s;
  s.texturing.pictures = {chessboard()};
  const std::uint32_t texture = s.texturing.add(scene::Texture{.minify = minify});
  const std::uint32_t maps = s.texturing.add(scene::MaterialMaps{.emission = vec3(1), .base = texture});
  s.materials = {scene::Material{.maps = maps}};
  add_quad(s, {dvec3{-4000, 0, 0}, {4000, 0, 0}, {4000, 0, kFar}, {-4000, 0, kFar}}, 0);
  s.unlit = true;
  s.camera = scene::Camera{
      .from = {0.3, 1, 0.4}, .at = {0.3, 1, -1}, .up = {0, 1, 0}, .vertical_fov = 2 * std::atan(kHalfHeight)};
  return s;
}

Picture rendered(const scene::Scene& model, int samples = 1, double adaptive_target = 0) {
  Renderer renderer(Scene{scene::Scene(model)}, {}, device_of());
  RenderOptions options = exact_options(kWidth, kHeight);
  options.samples = samples;
  options.adaptive_target = adaptive_target;
  return renderer.render(options);
}

// The integral from 0 to x of a wave that is 1 and -1 in turn, for a length of 1 each.
double wave_integral(double x) {
  const double phase = x - 2 * std::floor(x / 2);
  return phase < 1 ? phase : 2 - phase;
}

// The mean light of a pixel: along a row the chessboard's integral is exact, across it rows are so thin that
// no more can be had of it.
double mean_of_pixel(int column, int row) {
  constexpr int kRows = 400;
  const double pixel = 2 * kHalfHeight / kHeight;
  double sum = 0;
  for (int k = 0; k < kRows; ++k) {
    const double y = kHalfHeight - (row + (k + 0.5) / kRows) * pixel;  // below 0: downwards
    const double distance = 1 / -y, z = 0.4 - distance;
    const double left = (column - kWidth / 2.0) * pixel, right = left + pixel;
    const double x0 = 0.3 + left * distance, x1 = 0.3 + right * distance;
    const double wave = (wave_integral(x1) - wave_integral(x0)) / (x1 - x0);
    sum += 0.5 + 0.5 * wave * (std::fmod(std::floor(-z), 2) == 0 ? -1 : 1);
  }
  return sum / kRows;
}

constexpr int kFirstRow = kHeight / 2 + 1, kRowsOfFloor = kHeight - kFirstRow;

double shown(const Picture& picture, int column, int row) {
  return picture.rgb[3 * static_cast<std::size_t>(row * kWidth + column)];
}

// Root mean square over the pixels that show the floor and nothing else.
template <class Wanted>
double error_from(const Picture& picture, const Wanted& wanted) {
  double sum = 0;
  for (int y = kFirstRow; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double off = shown(picture, x, y) - wanted(x, y);
      sum += off * off;
    }
  return std::sqrt(sum / (kWidth * kRowsOfFloor));
}
double error_of(const Picture& picture) {
  return error_from(picture, mean_of_pixel);
}

TEST(Mipmaps, AreNearAnExactMeanOverThePixel) {
  const double mixed = error_of(rendered(floor_of(scene::Minify::linear_mipmap_linear)));
  const double nearest = error_of(rendered(floor_of(scene::Minify::linear_mipmap_nearest)));
  const double without = error_of(rendered(floor_of(scene::Minify::as_magnified)));
  RecordProperty("error_with_mipmaps", std::to_string(mixed));
  RecordProperty("error_without", std::to_string(without));
  EXPECT_LT(mixed, 0.03);
  EXPECT_LT(nearest, 0.08);
  EXPECT_GT(without, 4 * mixed);
}

// Footprints become smaller with more samples, so that the mean of the samples isn't blurred twice.
TEST(Mipmaps, SamplesDoNotBlurTwice) {
  EXPECT_LT(error_of(rendered(floor_of(scene::Minify::linear_mipmap_linear), 16)), 0.03);
}

// Nor do those of adaptive sampling: what is refined further comes nearer to many samples, as it believes.
// (To the exact mean of fields without slopes between them nothing comes nearer than some 0.02.)
TEST(Mipmaps, RefinedPixelsAreNotBlurredTwice) {
  const scene::Scene floor = floor_of(scene::Minify::linear_mipmap_linear);
  const Picture many = rendered(floor, 256);
  for (const double target : {0.02, 0.01, 0.005}) {
    const double error =
        error_from(rendered(floor, 1, target), [&](int x, int y) { return shown(many, x, y); });
    RecordProperty("error_at_" + std::to_string(target), std::to_string(error));
    EXPECT_LT(error, 2 * target);
  }
}

double mean_difference(const Picture& a, const Picture& b, bool mirrored) {
  double sum = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto at = [&](const Picture& p, int column) {
        return double{p.rgb[3 * static_cast<std::size_t>(y * kWidth + column)]};
      };
      sum += std::abs(at(a, x) - at(b, mirrored ? kWidth - 1 - x : x));
    }
  return sum / (kWidth * kHeight);
}

// Seen in a mirror between the camera and the floor's edge, from where its mirror image stands.
TEST(Mipmaps, AreTheSameInAMirror) {
  const scene::Scene floor = floor_of(scene::Minify::linear_mipmap_linear);
  scene::Scene mirror = floor;
  mirror.materials.push_back({.reflect = vec3(1)});
  add_quad(mirror, {dvec3{-9, -9, 0.1}, {-9, 9, 0.1}, {9, 9, 0.1}, {9, -9, 0.1}}, 1);
  mirror.camera->from = {0.3, 1, -0.2};
  mirror.camera->at = {0.3, 1, 1};
  EXPECT_LT(mean_difference(rendered(floor), rendered(mirror), true), 0.002);
  EXPECT_GT(mean_difference(rendered(floor), rendered(floor_of(scene::Minify::as_magnified)), false), 0.02);
}

TEST(Mipmaps, AreTheSameThroughAPane) {
  const scene::Scene floor = floor_of(scene::Minify::linear_mipmap_linear);
  scene::Scene pane = floor;
  pane.materials.push_back({.transmit = vec3(1)});
  add_quad(pane, {dvec3{-9, -9, 0.1}, {-9, 9, 0.1}, {9, 9, 0.1}, {9, -9, 0.1}}, 1);
  EXPECT_LT(mean_difference(rendered(floor), rendered(pane), false), 0.002);
}

// A ball far above the floor widens what it mirrors: of the chessboard its mean is left.
TEST(Mipmaps, AreCoarserInAConvexMirror) {
  const auto in_ball = [](scene::Minify minify) {
    scene::Scene s = floor_of(minify);
    s.materials.push_back({.reflect = vec3(1)});
    s.spheres.push_back({.center = {0.3, 30, -40}, .radius = 1});
    s.spheres.back().material = 1;
    s.spheres.back().number = 2;
    s.camera->at = {0.3, 30, -40};
    s.camera->vertical_fov = 0.05;
    return rendered(s);
  };
  const auto unrest = [](const Picture& p) {
    double sum = 0;
    int n = 0;
    for (int y = kHeight * 3 / 4 - 4; y < kHeight * 3 / 4 + 4; ++y)
      for (int x = kWidth / 2 - 8; x < kWidth / 2 + 8; ++x, ++n)
        sum += std::abs(p.rgb[3 * static_cast<std::size_t>(y * kWidth + x)] -
                        p.rgb[3 * static_cast<std::size_t>(y * kWidth + x + 1)]);
    return sum / n;
  };
  EXPECT_LT(unrest(in_ball(scene::Minify::linear_mipmap_linear)),
            0.5 * unrest(in_ball(scene::Minify::as_magnified)));
}

}  // namespace
}  // namespace kdray::test
