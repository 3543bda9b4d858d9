// What    Height fields: mount, which is fractal, and sombrero.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"

namespace kdray::generate {

// ---- mount: a fractal mountain by midpoint displacement, and a pyramid of four glass spheres before it.
// Size n: 2*4^n triangles, 4 spheres, 1 light.
// Haines 1987, section "mount"; L. Carpenter's subdivision. The heights come from a hash of the
// place, the published one, whose repetition is well known: the same mountain as everyone else's
// matters more than a better one. Normal deviates: Marsaglia's polar method over the
// 134456-8121-28411 congruential generator.

namespace {

constexpr double kFractalDimension = 2.2;
constexpr std::uint32_t kMountain = 21;  // another number, another mountain
constexpr double kCorner = -1, kWidth = 2;
// This stands for the root of 2. It is the published figure, whose rounding shows in low valleys.
constexpr double kDiagonal = 1.4142136;

double normal_deviate(std::uint32_t seed) {
  constexpr std::uint32_t modulus = 134456, factor = 8121, increment = 28411;
  const auto next = [&] {
    seed = (factor * seed + increment) % modulus;
    return 2.0 * seed / modulus - 1;
  };
  while (true) {
    const double a = next(), b = next();
    const double square = a * a + b * b;
    if (square < 1) return a * std::sqrt(-2 * std::log(square) / square);
  }
}

std::uint64_t shifted(int value, int bits) {
  const auto v = static_cast<std::uint64_t>(value);
  return bits >= 0 ? v << bits : v >> -bits;
}

class Mountain {
 public:
  Mountain(NffWriter& nff, int levels) : nff_(nff), levels_(levels), points_(1 << levels) {
    const double ratio = 2 / std::pow(2.0, 1 / (kFractalDimension - 1));
    roughness_ = std::sqrt(ratio * ratio - 1);
  }

  // Divides the square of `width` cells from (x, y) on; z has the heights of its corners, counter-clockwise
  // from there.
  void grow(int width, int x, int y, const std::array<double, 4>& z) {
    if (width == 1) return write_cell(x, y, z);
    const int h = width / 2;
    const double rise = h * kWidth / points_ * roughness_;
    const double lower = (z[0] + z[1]) / 2 + rise * deviate(x + h, y);
    const double right = (z[1] + z[2]) / 2 + rise * deviate(x + width, y + h);
    const double upper = (z[2] + z[3]) / 2 + rise * deviate(x + h, y + width);
    const double left = (z[3] + z[0]) / 2 + rise * deviate(x, y + h);
    const double middle = (z[0] + z[1] + z[2] + z[3]) / 4 + kDiagonal * rise * deviate(x + h, y + h);
    grow(h, x, y, {z[0], lower, middle, left});
    grow(h, x + h, y, {lower, z[1], right, middle});
    grow(h, x + h, y + h, {middle, right, z[2], upper});
    grow(h, x, y + h, {left, middle, upper, z[3]});
  }

 private:
  double deviate(int x, int y) const {
    const std::uint64_t hash =
        (shifted(x, 23 - levels_) + shifted(y, 15 - levels_) + shifted(x, 7 - levels_)) & 0xffff;
    return normal_deviate(kMountain + static_cast<std::uint32_t>(hash));
  }

  dvec3 point(int x, int y, double z) const {
    return {kCorner + x * kWidth / points_, kCorner + y * kWidth / points_, z};
  }

  void write_cell(int x, int y, const std::array<double, 4>& z) {
    const dvec3 a = point(x, y, z[0]), c = point(x + 1, y + 1, z[2]);
    nff_.polygon({a, point(x + 1, y, z[1]), c});
    nff_.polygon({c, point(x, y + 1, z[3]), a});
  }

  NffWriter& nff_;
  int levels_;
  int points_;
  double roughness_;
};

void write_spheres(NffWriter& nff, const dvec3& center, double radius) {
  const dvec3 top{0, 0, radius * std::sqrt(1.5)};
  nff.sphere(center + top, radius);
  const double h = std::numbers::sqrt2 / 2;
  const dvec3 low = rotation({h, h, 0}, std::acos(-1.0 / 3)) * top;
  for (int i = 0; i < 3; ++i) nff.sphere(center + rotation_z(i * 2 * std::numbers::pi / 3) * low, radius);
}

}  // namespace

void write_mount(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {-1.6, 1.6, 1.7}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 45, .hither = 0.01});
  nff.light({-100, -100, 100});
  nff.surface(
      {.color = {1, 1, 1}, .diffuse = 0.1, .specular = 0.1, .shine = 101.148, .transmit = 0.9, .index = 1.5});
  write_spheres(nff, {-0.8, 0.8, 1}, 0.17);
  nff.surface({.color = {0.5, 0.45, 0.35}, .diffuse = 1, .specular = 0});
  Mountain(nff, size).grow(1 << size, 0, 0, {0, 0, 0, 0});
}

// ---- sombrero: a damped cosine as a height field over a square grid.
// Size n: a grid of (16*2^n)^2 points, 2*(16*2^n - 1)^2 triangles, 1 light.
// The SPD package (A. Enzmann).

namespace {

constexpr double kLow = -4, kExtent = 8, kFloor = -3;

class HeightField {
 public:
  explicit HeightField(int points) : points_(points) {}

  // The function is sampled at points_ steps over the extent and the grid spread over all of it, so the last
  // row shows the function one step before the edge: the published field, off its own formula by a step.
  dvec3 at(int column, int row) const {
    const double x = kLow + kExtent * column / points_, z = kLow + kExtent * row / points_;
    const double r = std::hypot(x, z);
    const double height = std::cos(2 * std::numbers::pi * r) * std::exp(-r);
    const int last = points_ - 1;
    return {kLow + kExtent * column / last, kFloor + height, kLow + kExtent * row / last};
  }

 private:
  int points_;
};

}  // namespace

void write_sombrero(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {0, 5, -8}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 40, .hither = 0.01});
  nff.light({10, 10, -10});
  nff.surface({.color = {1, 0.1, 0.1}, .diffuse = 0.8, .specular = 0, .shine = 2.60078, .index = 1});
  const int points = 16 << size;
  const HeightField field(points);
  for (int row = 0; row + 1 < points; ++row)
    for (int column = 0; column + 1 < points; ++column) {
      const dvec3 a = field.at(column, row), c = field.at(column + 1, row + 1);
      nff.polygon({a, c, field.at(column + 1, row)});
      nff.polygon({a, field.at(column, row + 1), c});
    }
}

}  // namespace kdray::generate
