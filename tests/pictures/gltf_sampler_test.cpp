// What    Samplers of glTF as whole frames show them: each pair of wrapping modes, nearest and linear, both
//         sets of coordinates and KHR_texture_transform (rotated, mirrored by a negative scale, moved), on
//         pictures of odd sizes and of one texel, against a sampler in double that follows the two
//         specifications.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pictures/render.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/pictures.h"

namespace kdray::test {
namespace {

using nlohmann::json;
using Pair = std::array<double, 2>;

constexpr int kSide = 24;
constexpr int kRepeat = 10497, kMirror = 33648, kClamp = 33071, kNearest = 9728, kLinear = 9729;

struct Codes {
  int width, height;
  std::vector<std::uint16_t> rgb;  // codes of sRGB
};

Codes noise(int width, int height) {
  Codes c{width, height, {}};
  std::mt19937 random(36);
  for (int i = 0; i < 3 * width * height; ++i) c.rgb.push_back(static_cast<std::uint16_t>(random() % 256));
  return c;
}

struct Transform {
  Pair offset{0, 0}, scale{1, 1};
  double rotation = 0;

  // T * R * S of the extension, for coordinates that grow to the right and down.
  Pair of(const Pair& uv) const {
    const double u = uv[0] * scale[0], v = uv[1] * scale[1], c = std::cos(rotation), s = std::sin(rotation);
    return {c * u + s * v + offset[0], -s * u + c * v + offset[1]};
  }
  json text() const { return {{"offset", offset}, {"scale", scale}, {"rotation", rotation}}; }
};

constexpr std::array<Transform, 4> kTransforms = {Transform{}, Transform{{0.25, -0.4}, {1, 1}, 0.6},
                                                  Transform{{0.7, 0.1}, {-1.7, 2.3}, 0},
                                                  Transform{{-1.3, 0.45}, {2.2, -0.8}, -2.5}};

struct Case {
  int across, down, filter, set;
  Transform transform;
};

// Where the second set lies: turned by a right angle, larger, and beyond the picture on all sides.
Pair coordinates(const Pair& place, int set) {
  return set == 0 ? place : Pair{2.5 * place[1] - 0.75, 3 * place[0] - 1.25};
}

scene::Scene square_of(const Case& c, const Codes& codes) {
  GltfSample sample = square();
  json& j = sample.json;
  j["images"] = {{{"uri", "data:image/png;base64," + base64(png(codes.width, codes.height, 3, codes.rgb))}}};
  j["samplers"] = {
      {{"wrapS", c.across}, {"wrapT", c.down}, {"magFilter", c.filter}, {"minFilter", c.filter}}};
  j["textures"] = {{{"source", 0}, {"sampler", 0}}};
  json& material = j["materials"][0];
  material["extensions"]["KHR_materials_unlit"] = json::object();
  json& texture = material["pbrMetallicRoughness"]["baseColorTexture"];
  texture = {{"index", 0}, {"texCoord", 0}};
  texture["extensions"]["KHR_texture_transform"] = c.transform.text();
  texture["extensions"]["KHR_texture_transform"]["texCoord"] = c.set;
  sample.primitive()["material"] = 0;
  for (const int set : {0, 1}) {
    std::vector<float> values;
    for (const Pair& place : {Pair{0, 1}, {1, 1}, {1, 0}, {0, 0}})
      for (const double x : coordinates(place, set)) values.push_back(static_cast<float>(x));
    sample.primitive()["attributes"]["TEXCOORD_" + std::to_string(set)] =
        sample.accessor(sample.view(bytes_of(values)), 5126, "VEC2", 4);
  }
  scene::Scene s = scene::read_gltf(sample.text(), "a.gltf");
  EXPECT_TRUE(s.warnings.empty());
  s.unlit = true;
  s.camera = scene::Camera{.from = {0.5, 0.5, 3}, .at = {0.5, 0.5, 0}, .up = {0, 1, 0}, .ortho_width = 1};
  return s;
}

double curve(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

long wrapped(long i, long n, int mode) {
  const auto modulo = [](long a, long b) { return ((a % b) + b) % b; };
  if (mode == kClamp) return std::clamp(i, 0L, n - 1);
  if (mode == kRepeat) return modulo(i, n);
  const long m = modulo(i, 2 * n);
  return m < n ? m : 2 * n - 1 - m;
}

double texel(const Case& c, const Codes& codes, double x, double y, std::size_t channel) {
  const long column = wrapped(std::lround(std::floor(x)), codes.width, c.across),
             row = wrapped(std::lround(std::floor(y)), codes.height, c.down);
  return curve(codes.rgb[3 * static_cast<std::size_t>(row * codes.width + column) + channel] / 255.0);
}

double looked_up(const Case& c, const Codes& codes, const Pair& uv, std::size_t channel) {
  const double x = uv[0] * codes.width, y = uv[1] * codes.height;
  if (c.filter == kNearest) return texel(c, codes, x, y, channel);
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5), fx = x - 0.5 - left, fy = y - 0.5 - top;
  double sum = 0;
  for (const int j : {0, 1})
    for (const int i : {0, 1})
      sum += texel(c, codes, left + i, top + j, channel) * (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
  return sum;
}

bool at_border(double x) {
  return std::abs(x - std::round(x)) < 0.01;
}

void expect_as_specified(const Case& c, const Codes& codes) {
  SCOPED_TRACE(testing::Message() << "wrap " << c.across << ", " << c.down << ", filter " << c.filter
                                  << ", set " << c.set << ", rotation " << c.transform.rotation << ", "
                                  << codes.width << "x" << codes.height);
  Renderer renderer(Scene{square_of(c, codes)}, {}, device_of());
  const Picture got = renderer.render(exact_options(kSide, kSide, 1));
  std::size_t n_checked = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Pair uv = c.transform.of(coordinates({(x + 0.5) / kSide, (y + 0.5) / kSide}, c.set));
      if (c.filter == kNearest && (at_border(uv[0] * codes.width) || at_border(uv[1] * codes.height)))
        continue;
      ++n_checked;
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_NEAR(got.rgb[3 * static_cast<std::size_t>(y * kSide + x) + k], looked_up(c, codes, uv, k),
                    c.filter == kNearest ? 1e-4 : 0.006)
            << x << ", " << y << ", " << k;
    }
  EXPECT_GT(n_checked, std::size_t{kSide * kSide / 2});
}

TEST(GltfSampler, IsThatOfTheSpecification) {
  const Codes odd = noise(5, 3);
  int n = 0;  // the sets take turns, each with all transforms
  for (const int across : {kRepeat, kMirror, kClamp})
    for (const int down : {kRepeat, kMirror, kClamp})
      for (const int filter : {kNearest, kLinear})
        for (const Transform& transform : kTransforms) {
          expect_as_specified({across, down, filter, (n + n / 4) % 2, transform}, odd);
          ++n;
        }
}

TEST(GltfSampler, OneTexelIsSeenEverywhere) {
  const Codes one = noise(1, 1);
  for (const int wrap : {kRepeat, kMirror, kClamp})
    for (const int filter : {kNearest, kLinear})
      expect_as_specified({wrap, wrap, filter, 1, kTransforms[3]}, one);
}

// Half a texel from the edge on, a clamped picture shows the edge's texel and nothing of the other side.
TEST(GltfSampler, ClampedPicturesStayTheSameBeyondTheirEdges) {
  const Codes two{2, 1, {255, 0, 0, 0, 0, 255}};
  const Case c{kClamp, kClamp, kLinear, 0, Transform{{-1, 0}, {3, 1}, 0}};
  expect_as_specified(c, two);
  Renderer renderer(Scene{square_of(c, two)}, {}, device_of());
  const Picture got = renderer.render(exact_options(kSide, kSide, 1));
  for (int x = 0; x < kSide; ++x) {
    const double u = 3 * (x + 0.5) / kSide - 1;
    const std::size_t at = 3 * static_cast<std::size_t>(x);
    if (u < 0.25) {
      EXPECT_EQ(got.rgb[at + 2], 0) << x;
    }
    if (u > 0.75) {
      EXPECT_EQ(got.rgb[at], 0) << x;
    }
  }
}

}  // namespace
}  // namespace kdray::test
