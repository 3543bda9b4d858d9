// What    gears: a cube of meshing gears whose faces are concave 144-gons, over a mirroring ground.
// Shape   Size n: n^3 gears of 146 polygons each, 1 ground polygon, 5 lights.
// Source  Haines 1987, section "gears".
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "scene/generate/nff_writer.h"

namespace kdray::generate {

namespace {

constexpr int kTeeth = 36;
constexpr double kOuter = 0.995;  // of the pitch the gears mesh at; below 1, so that no two surfaces coincide
constexpr double kInner = 0.9;
using std::numbers::pi;

struct Gear {
  dvec3 center;  // of the upper face
  double turn;   // radians
  double outer_radius, inner_radius, thickness;
};

// Returns the outline at the height z. For the lower face `sense` is -1, and it goes round the other way.
std::vector<dvec3> outline(const Gear& g, double z, int sense) {
  constexpr double tooth = 2 * pi / kTeeth;
  struct Corner {
    double at;  // in teeth
    bool outer;
  };
  constexpr std::array<Corner, 4> corners{Corner{-0.19, true}, {0.19, true}, {0.3, false}, {0.7, false}};
  std::vector<dvec3> points;
  points.reserve(4 * kTeeth);
  for (int i = 0; i < kTeeth; ++i)
    for (const Corner& c : corners) {
      const double angle = g.turn + sense * tooth * (i + c.at);
      const double radius = c.outer ? g.outer_radius : g.inner_radius;
      points.emplace_back(g.center.x + radius * std::cos(angle), g.center.y + radius * std::sin(angle), z);
    }
  return points;
}

void write_gear(NffWriter& nff, const Gear& g) {
  const dvec3 down{0, 0, -g.thickness};
  const std::vector<dvec3> top = outline(g, g.center.z, +1);
  nff.polygon(top);
  for (std::size_t i = 0; i < top.size(); ++i) {
    const dvec3& a = top[i];
    const dvec3& b = top[(i + 1) % top.size()];
    nff.polygon({a, a + down, b + down, b});
  }
  nff.polygon(outline(g, g.center.z - g.thickness, -1));
}

double fraction(double x) {
  return x - std::floor(x);
}

// The colours look random but follow from the gear's place, in sevenths, made as bright as they go.
Surface surface_of(int x, int y, int z) {
  const dvec3 raw(0.01 + fraction((x * 3 + y * 2 + z + 1) * 5 / 7.0),
                  0.01 + fraction((y * 3 + z * 2 + x + 1) * 3 / 7.0),
                  0.01 + fraction((z * 3 + x * 2 + y + 1) * 2 / 7.0));
  const dvec3 color = raw / std::max({raw.x, raw.y, raw.z});
  const bool glass = (x * 4 + y * 2 + z) % 5 == 0;
  if (glass) return {.color = color, .diffuse = 0.2, .specular = 0, .transmit = 0.8, .index = 1.1};
  return {.color = color, .diffuse = 1, .specular = 0};
}

void write_head(NffWriter& nff) {
  nff.background(kSkyBlue);
  nff.view({.from = {-1.1, -2.1, 2.6}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 45, .hither = 1});
  nff.light({2, 4, 4});
  nff.light({-2, 4, 3});
  nff.light({2, -2.5, 2.5});
  nff.light({-1, -4, 2});
  nff.light({-1.111, -2.121, 2.626});
  nff.surface({.color = {1, 0.85, 0.7}, .diffuse = 0.3, .specular = 0.6, .shine = 3.0827});
  nff.polygon({{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}});
}

}  // namespace

void write_gears(std::ostream& out, int size) {
  NffWriter nff(out);
  write_head(nff);
  constexpr double depth = 1 - kInner;  // of the teeth
  const double radius = 1 / (size - (size - 1) * depth / 2);
  const double thickness = std::min(0.1, 1.0 / (2.0 * size));
  for (int z = 0; z < size; ++z)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        nff.surface(surface_of(x, y, z));
        const double pitch = radius * (2 - depth);
        write_gear(nff, {.center = {-1 + radius + x * pitch, -1 + radius + y * pitch, 1 - z * (1.0 / size)},
                         .turn = (x + y + z) % 2 * pi / kTeeth,
                         .outer_radius = kOuter * radius,
                         .inner_radius = kInner * radius,
                         .thickness = thickness});
      }
}

}  // namespace kdray::generate
