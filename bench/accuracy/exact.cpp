#include "bench/accuracy/exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/timer.h"
#include "io/image/compare.h"

namespace kdray::bench {

namespace {

constexpr const char* kChessboard = "chessboard";
constexpr const char* kPenumbra = "penumbra";

// ---- The chessboard: the floor y = 0 from the plane z = 0 to z = kFar, seen from kEye along -z.

constexpr double kHalfHeight = 0.4, kFar = -4000,
                 kHalfWidth = 16000;        // the first of the picture, at distance 1
constexpr double kEyeX = 0.3, kEyeZ = 0.4;  // at a height of 1

// Fields of a length of 1, black and white, 16 texels each.
std::shared_ptr<const scene::Picture> chessboard_picture() {
  scene::Picture p = scene::blank_picture(kChessboard, 32, 32);
  std::uint8_t* to = p.texels.data();
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto v = static_cast<std::uint8_t>((x / 16 + y / 16) % 2 == 0 ? 255 : 0);
      for (const std::uint8_t byte : {v, v, v, std::uint8_t{255}}) *to++ = byte;
    }
  return std::make_shared<const scene::Picture>(std::move(p));
}

void add_quad(scene::Scene& s, const std::array<dvec3, 4>& corners, bool textured) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& p : corners) s.vertices.push_back(p);
  for (const std::array<std::uint32_t, 3>& pick : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}}) {
    scene::Triangle t{.vertex = {first + pick[0], first + pick[1], first + pick[2]}};
    t.number = static_cast<std::uint32_t>(s.triangles.size());
    s.triangles.push_back(t);
    if (!textured) continue;
    layout::TexCoords at{};
    for (std::size_t k = 0; k < 3; ++k) {
      at.uv[k][0] = static_cast<float>(corners[pick[k]].x / 2);
      at.uv[k][1] = static_cast<float>(corners[pick[k]].z / 2);
    }
    s.texturing.texcoords[0].push_back(at);
  }
}

scene::Scene chessboard() {
  scene::Scene s;
  s.texturing.pictures = {chessboard_picture()};
  const std::uint32_t texture =
      s.texturing.add(scene::Texture{.minify = scene::Minify::linear_mipmap_linear});
  const std::uint32_t maps = s.texturing.add(scene::MaterialMaps{.emission = vec3(1), .base = texture});
  s.materials = {scene::Material{.maps = maps}};
  add_quad(s, {dvec3{-kHalfWidth, 0, 0}, {kHalfWidth, 0, 0}, {kHalfWidth, 0, kFar}, {-kHalfWidth, 0, kFar}},
           true);
  s.unlit = true;
  s.camera = scene::Camera{.from = {kEyeX, 1, kEyeZ},
                           .at = {kEyeX, 1, -1},
                           .up = {0, 1, 0},
                           .vertical_fov = 2 * std::atan(kHalfHeight)};
  return s;
}

// The picture between its texels' middles is 0.5 + 0.5 * wave(x) * wave(z): 1 and -1 in turn, for a length of
// 1 each, with straight slopes of a texel between them.
constexpr double kHalfTexel = 1.0 / 32;

double wave(double x) {
  const double phase = x - 2 * std::floor(x / 2), from_edge = phase < 0.5   ? phase
                                                              : phase < 1.5 ? 1 - phase
                                                                            : phase - 2;
  return std::clamp(from_edge / kHalfTexel, -1.0, 1.0);
}

// Its integral from 0 to x.
double wave_integral(double x) {
  const auto of_positive_half = [](double p) {
    const double rest = std::min(p, 1 - p);  // to the nearer edge
    const double slope = rest < kHalfTexel ? (kHalfTexel - rest) * (kHalfTexel - rest) / (2 * kHalfTexel) : 0;
    return p < 0.5 ? p - kHalfTexel / 2 + slope : p - kHalfTexel / 2 - slope;
  };
  const double phase = x - 2 * std::floor(x / 2);
  return phase < 1 ? of_positive_half(phase) : of_positive_half(1) - of_positive_half(phase - 1);
}

image::Image mean_chessboard(int width, int height, int rows_of_pixel) {
  const double pixel = 2 * kHalfHeight / height;
  image::Image image{width, height, {}};
  std::vector<double> sums(static_cast<std::size_t>(width));
  for (int row = 0; row < height; ++row) {
    std::ranges::fill(sums, 0.0);
    for (int k = 0; k < rows_of_pixel; ++k) {
      const double y = kHalfHeight - (row + (k + 0.5) / rows_of_pixel) * pixel;
      if (y >= 0) continue;
      const double distance = 1 / -y, z = kEyeZ - distance;
      if (z < kFar || z > 0) continue;
      const double sign = 0.5 * wave(z);
      const auto edge = [&](int column) { return kEyeX + (column - width / 2.0) * pixel * distance; };
      for (int column = 0; column < width; ++column)
        sums[static_cast<std::size_t>(column)] +=
            0.5 + sign * (wave_integral(edge(column + 1)) - wave_integral(edge(column))) / (pixel * distance);
    }
    for (const double sum : sums) image.pixels.emplace_back(static_cast<float>(sum / rows_of_pixel));
  }
  return image;
}

// ---- The penumbra: the floor y = 0, above it a sheet that covers all where x < 0, above that the light.

constexpr double kLight = 4, kEdge = 2, kWide = 4;  // the last of the picture
constexpr double kLightX = 0.1, kHalfAcross = 0.8, kHalfDown = 0.6;

scene::Scene penumbra() {
  scene::Scene s;
  s.materials = {scene::Material{.diffuse = vec3(1)}};
  add_quad(s, {dvec3{-50, 0, 50}, {50, 0, 50}, {50, 0, -50}, {-50, 0, -50}}, false);
  add_quad(s, {dvec3{-50, kEdge, 50}, {0, kEdge, 50}, {0, kEdge, -50}, {-50, kEdge, -50}}, false);
  scene::Light light;
  light.kind = scene::LightKind::rectangle;
  light.position = {kLightX, kLight, 0};
  light.across = {2 * kHalfAcross, 0, 0}, light.down = {0, 0, 2 * kHalfDown};
  s.lights = {light};
  s.camera = scene::Camera{.from = {0, 1, 0}, .at = {0, 0, 0}, .up = {0, 0, 1}, .ortho_width = kWide};
  return s;
}

// Whose mixed derivative is 1 / sqrt(u^2 + v^2 + kLight^2): the potential of a rectangle's corner.
double corner(double u, double v) {
  const double h = kLight, r = std::sqrt(u * u + v * v + h * h);
  return u * std::asinh(v / std::sqrt(h * h + u * u)) + v * std::asinh(u / std::sqrt(h * h + v * v)) -
         h * std::atan(u * v / (h * r));
}

// The mean over the light of the cosine at the floor, where the light is seen past the sheet's edge.
double light_at(double x, double z) {
  const double lo = std::max(kLightX - kHalfAcross, x - x * kLight / kEdge) - x,
               hi = kLightX + kHalfAcross - x;
  if (lo >= hi) return 0;
  const double near = -kHalfDown - z, far = kHalfDown - z;
  const double sum = corner(hi, far) - corner(lo, far) - corner(hi, near) + corner(lo, near);
  return kLight * sum / (4 * kHalfAcross * kHalfDown);
}

image::Image mean_penumbra(int width, int height, int places) {
  const double pixel = kWide / width;
  image::Image image{width, height, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      double sum = 0;
      for (int i = 0; i < places * places; ++i) {
        const double right = column + (i % places + 0.5) / places, down = row + (i / places + 0.5) / places;
        sum += light_at((width / 2.0 - right) * pixel, (height / 2.0 - down) * pixel);  // the right is -x
      }
      image.pixels.emplace_back(static_cast<float>(sum / (places * places)));
    }
  return image;
}

// ---- Both

using Mean = image::Image (*)(int width, int height, int places);

template <Mean mean, int kPlaces>
Reference exact_reference(int width, int height) {
  const Timer timer;
  Reference r;
  r.image = mean(width, height, kPlaces);
  r.own_error = image::compare(r.image, mean(width, height, kPlaces / 2)).rmse;
  r.seconds = timer.seconds();
  return r;
}

}  // namespace

std::optional<ExactScene> exact_scene(const std::string& name) {
  if (name == kChessboard) return ExactScene{chessboard(), exact_reference<mean_chessboard, 512>};
  if (name == kPenumbra) return ExactScene{penumbra(), exact_reference<mean_penumbra, 8>};
  return std::nullopt;
}

}  // namespace kdray::bench
