// What    The teapot's numbers: profiles of the round parts and cross sections of the tubes.
#include "scene/generate/teapot_patches.h"

#include <cstddef>
#include <span>

namespace kdray::generate {

namespace {

// A control point of a profile: its radius, the tangent handle of the quarter arc there, its height.
struct ProfilePoint {
  double radius, handle, z;
};

constexpr ProfilePoint round(double radius, double z) {
  return {radius, 0.56 * radius, z};
}

constexpr std::array kRim{round(1.4, 2.4), round(1.3375, 2.53125), round(1.4375, 2.53125), round(1.5, 2.4)};
constexpr std::array kBody{round(1.5, 2.4), round(1.75, 1.875), round(2, 1.35),  round(2, 0.9),
                           round(2, 0.45),  round(1.5, 0.225),  round(1.5, 0.15)};
constexpr std::array kLid{round(0, 3.15),   ProfilePoint{0.8, 0.45, 3.15},
                          round(0, 2.85),   round(0.2, 2.7),
                          round(0.4, 2.55), round(1.3, 2.55),
                          round(1.3, 2.4)};
constexpr std::array kBottom{round(0, 0), round(1.425, 0), round(1.5, 0.075), round(1.5, 0.15)};

// A cross section of a tube that is mirrored in y = 0: from (x0, z0) around, at y = -half, to (x1, z1).
struct Section {
  double x0, z0, x1, z1, half;
};

constexpr std::array kHandle{Section{-1.6, 2.025, -1.5, 2.25, 0.3}, Section{-2.3, 2.025, -2.5, 2.25, 0.3},
                             Section{-2.7, 2.025, -3, 2.25, 0.3},   Section{-2.7, 1.8, -3, 1.8, 0.3},
                             Section{-2.7, 1.575, -3, 1.35, 0.3},   Section{-2.5, 1.125, -2.65, 0.9375, 0.3},
                             Section{-2, 0.9, -1.9, 0.6, 0.3}};
constexpr std::array kSpout{
    Section{1.7, 1.425, 1.7, 0.6, 0.66},       Section{2.6, 1.425, 3.1, 0.825, 0.66},
    Section{2.3, 2.1, 2.4, 2.025, 0.25},       Section{2.7, 2.4, 3.3, 2.4, 0.25},
    Section{2.8, 2.475, 3.525, 2.49375, 0.25}, Section{2.9, 2.475, 3.45, 2.5125, 0.15},
    Section{2.8, 2.4, 3.2, 2.4, 0.15}};

enum class Sense { clockwise, counter_clockwise };  // seen from above

// Quarter turns are exact: without rounding, neighbouring patches meet in the same numbers.
dvec3 quarter_turns(dvec3 p, int turns, Sense sense) {
  for (int i = 0; i < turns; ++i)
    p = sense == Sense::clockwise ? dvec3(p.y, -p.x, p.z) : dvec3(-p.y, p.x, p.z);
  return p;
}

std::array<dvec3, 4> quarter_arc(const ProfilePoint& p, Sense sense) {
  const double side = sense == Sense::clockwise ? -1 : 1;
  return {dvec3{p.radius, 0, p.z},
          {p.radius, side * p.handle, p.z},
          {p.handle, side * p.radius, p.z},
          {0, side * p.radius, p.z}};
}

// Adds a ring of four patches for every three points along the profile; neighbours share a row.
void add_round(std::vector<BezierPatch>& patches, std::span<const ProfilePoint> profile, Sense sense) {
  for (std::size_t first = 0; first + 3 < profile.size(); first += 3)
    for (int quarter = 0; quarter < 4; ++quarter) {
      BezierPatch& patch = patches.emplace_back();
      for (std::size_t row = 0; row < 4; ++row) {
        patch[row] = quarter_arc(profile[first + row], sense);
        for (dvec3& p : patch[row]) p = quarter_turns(p, quarter, sense);
      }
    }
}

void add_tube(std::vector<BezierPatch>& patches, std::span<const Section> sections) {
  for (std::size_t first = 0; first + 3 < sections.size(); first += 3) {
    BezierPatch near, far;
    for (std::size_t row = 0; row < 4; ++row) {
      const Section& s = sections[first + row];
      near[row] = {dvec3{s.x0, 0, s.z0}, {s.x0, -s.half, s.z0}, {s.x1, -s.half, s.z1}, {s.x1, 0, s.z1}};
      far[row] = {dvec3{s.x1, 0, s.z1}, {s.x1, s.half, s.z1}, {s.x0, s.half, s.z0}, {s.x0, 0, s.z0}};
    }
    patches.push_back(near);
    patches.push_back(far);
  }
}

}  // namespace

std::vector<BezierPatch> teapot_patches() {
  std::vector<BezierPatch> patches;
  patches.reserve(32);
  add_round(patches, kRim, Sense::clockwise);
  add_round(patches, kBody, Sense::clockwise);
  add_tube(patches, kHandle);
  add_tube(patches, kSpout);
  add_round(patches, kLid, Sense::clockwise);
  add_round(patches, kBottom, Sense::counter_clockwise);
  return patches;
}

}  // namespace kdray::generate
