// What    sombrero: a damped cosine as a height field over a square grid.
// Shape   Size n: a grid of (16*2^n)^2 points, 2*(16*2^n - 1)^2 triangles, 1 light.
// Source  The SPD package (A. Enzmann).
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

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
