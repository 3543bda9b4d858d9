// What    balls, or sphereflake: a sphere with nine spheres of a third of its radius on it, and so on.
// Shape   Size n: sum of 9^i for i = 0..n spheres, 1 polygon, 3 lights.
// Source  Haines 1987, section "balls".
#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

namespace {

constexpr double kShrink = 1.0 / 3.0;

using Directions = std::array<dvec3, 9>;

// Three directions out of the twelve to the neighbours of a ball in close packing, tilted so that their
// plane's normal is +z, then repeated at a third and two thirds of a turn: six around the equator and three
// above it.
Directions child_directions() {
  const double h = std::numbers::sqrt2 / 2;
  const std::array<dvec3, 3> trio{dvec3{h, h, 0}, {h, 0, -h}, {0, h, -h}};
  const dmat3 tilt = rotation({h, -h, 0}, std::asin(2 / std::sqrt(6.0)));
  Directions directions;
  for (int turn = 0; turn < 3; ++turn)
    for (int i = 0; i < 3; ++i)
      directions[3 * turn + i] = rotation_z(turn * 2 * std::numbers::pi / 3) * tilt * trio[i];
  return directions;
}

// Takes +z to `direction` the short way round.
dmat3 frame_of(const dvec3& direction) {
  const dvec3 axis = glm::cross(dvec3(0, 0, 1), direction);
  const double sine = glm::length(axis);
  if (sine < 1e-12) return direction.z > 0 ? dmat3(1) : rotation_y(std::numbers::pi);
  return rotation(axis / sine, std::atan2(sine, direction.z));
}

class Flake {
 public:
  explicit Flake(NffWriter& nff) : nff_(nff), directions_(child_directions()) {}

  void write(int levels, const dvec3& center, double radius, const dvec3& direction) {
    nff_.sphere(center, radius);
    if (levels == 0) return;
    const dmat3 frame = frame_of(direction);
    const double child_radius = radius * kShrink;
    for (const dvec3& d : directions_) {
      const dvec3 outward = frame * d;
      write(levels - 1, center + (radius + child_radius) * outward, child_radius, outward);
    }
  }

 private:
  NffWriter& nff_;
  Directions directions_;
};

}  // namespace

void write_balls(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {2.1, 1.3, 1.7}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 45, .hither = 0.01});
  nff.light({4, 3, 2});
  nff.light({1, -4, 4});
  nff.light({-3, 1, 5});
  nff.surface({.color = {1, 0.75, 0.33}, .diffuse = 0.8, .specular = 0, .index = 1});
  nff.polygon({{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}});
  nff.surface({.color = {1, 0.9, 0.7}, .diffuse = 0.5, .specular = 0.5, .shine = 3.0827, .index = 1});
  Flake(nff).write(size, {0, 0, 0}, 0.5, {0, 0, 1});
}

}  // namespace kdray::generate
