// What    Scenes that hold themselves in small: balls, jacks, tetra and tree.
#include <array>
#include <cmath>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"

namespace kdray::generate {

// ---- balls, or sphereflake: a sphere with nine spheres of a third of its radius on it, and so on.
// Size n: sum of 9^i for i = 0..n spheres, 1 polygon, 3 lights.
// Haines 1987, section "balls".

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

// ---- jacks: three crossed rods with a ball at each end, and half as large jacks in the eight octants
// between.
// Size n: (8^n - 1) / 7 jacks of 3 cones and 6 spheres; 1 light.
// The SPD package (A. Enzmann).

namespace {

constexpr double kReach = 0.75;  // of the arms in their cell, so that jacks keep apart
constexpr double kRod = 0.1, kBall = 0.2;

class Jacks {
 public:
  explicit Jacks(NffWriter& nff) : nff_(nff), frame_(rotation_x(-30 * kDegree) * rotation_y(-20 * kDegree)) {}

  void write(int levels, const dvec3& center, double scale) {
    write_one(center, kReach * scale);
    if (levels == 1) return;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5})
        for (const double z : {-0.5, 0.5})
          write(levels - 1, center + frame_ * (scale * dvec3(x, y, z)), scale / 2);
  }

 private:
  static constexpr double kDegree = std::numbers::pi / 180;

  void write_one(const dvec3& center, double scale) {
    for (int i = 0; i < 3; ++i)
      nff_.cone(center - scale * frame_[i], scale * kRod, center + scale * frame_[i], scale * kRod);
    for (const double side : {1.0, -1.0})
      for (int i = 0; i < 3; ++i) nff_.sphere(center + side * scale * frame_[i], scale * kBall);
  }

  NffWriter& nff_;
  dmat3 frame_;  // its columns are the arms
};

}  // namespace

void write_jacks(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background({0.2, 0.05, 0.2});
  nff.view({.from = {0, 0, -8},
            .at = {0, 0, 0},
            .up = {0, 1, 0},
            .angle = 25,
            .hither = 0.001,
            .resolution = 256});
  nff.light({-10, 3, -20});
  nff.surface(
      {.color = {0.737, 0.561, 0.561}, .diffuse = 0.7, .specular = 0.7, .shine = 11.1434, .index = 1});
  Jacks(nff).write(size, {0, 0, 0}, 1);
}

// ---- tetra: Sierpinski's tetrahedron.
// Size n: 4^n triangles, 1 light.
// Haines 1987, section "tetra"; the scene of A. Glassner, IEEE CG&A 4(10), 1984, and of Kay and
// Kajiya, 1986.

namespace {

// Four corners of a cube, no two of them joined by an edge of it.
constexpr std::array<dvec3, 4> kCorners{dvec3{-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}, {1, 1, 1}};

void write_tetrahedron(NffWriter& nff, const dvec3& center, double half) {
  constexpr int faces[4][3] = {{0, 1, 2}, {3, 2, 1}, {2, 3, 0}, {1, 0, 3}};
  for (const auto& f : faces)
    nff.polygon(
        {center + half * kCorners[f[0]], center + half * kCorners[f[1]], center + half * kCorners[f[2]]});
}

void write_levels(NffWriter& nff, int levels, const dvec3& center, double half) {
  if (levels == 1) return write_tetrahedron(nff, center, half);
  for (const dvec3& corner : kCorners) write_levels(nff, levels - 1, center + half / 2 * corner, half / 2);
}

}  // namespace

void write_tetra(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {1.02285, -3.17715, -2.17451},
            .at = {-0.004103, -0.004103, 0.216539},
            .up = {-0.816497, -0.816497, 0.816497},
            .angle = 45,
            .hither = 1});
  nff.light({2, -18, -5});
  nff.surface({.color = {1, 0.2, 0.2}, .diffuse = 1, .specular = 0});
  write_levels(nff, size, {0, 0, 0}, 1);
}

// ---- tree: a branch is a cone with a sphere on its end, from which two smaller branches grow.
// Size n: 2^(n+1) - 1 cones and as many spheres, 1 polygon, 7 lights.
// Haines 1987, section "tree"; M. Aono and T. Kunii, IEEE CG&A 4(5), 1984.

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kThickness = 0.15;  // of the trunk, whose length is 1
constexpr double kTaper = 0.67;

// How a branch's own frame, in which it runs along z to (0, 0, 1), lies in the tree's.
struct Frame {
  dmat3 turn{1};
  dvec3 origin{0};
};

class Tree {
 public:
  explicit Tree(NffWriter& nff) : nff_(nff) {
    bend_[0] = 0.65 * rotation_z(90 * kDegree) * rotation_x(40 * kDegree);
    bend_[1] = 0.70 * rotation_z(230 * kDegree) * rotation_x(25 * kDegree);
  }

  void grow(int levels, const Frame& frame, double scale) {
    const double radius = scale * kThickness;
    const dvec3 end = frame.origin + frame.turn[2];
    nff_.cone(frame.origin, radius, end, radius * kTaper);
    nff_.sphere(end, radius * kTaper);
    if (levels == 0) return;
    for (const dmat3& bend : bend_) grow(levels - 1, {frame.turn * bend, end}, scale * kTaper);
  }

 private:
  NffWriter& nff_;
  std::array<dmat3, 2> bend_;  // turn and shrink, from the parent's frame to the child's
};

}  // namespace

void write_tree(std::ostream& out, int size) {
  NffWriter nff(out);
  nff.background(kSkyBlue);
  nff.view({.from = {4.5, 0.4, 2}, .at = {0, 0, 1.5}, .up = {0, 0, 1}, .angle = 45, .hither = 1});
  for (const dvec3& light : {dvec3{-5, 5, 50},
                             {30, -30, 30},
                             {-40, -30, 20},
                             {10, 30, 40},
                             {-30, 40, 10},
                             {50, 25, 20},
                             {-10, -60, 30}})
    nff.light(light);
  nff.surface({.color = {0.2, 0.7, 0.2}, .diffuse = 1, .specular = 0});
  nff.polygon({{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}});
  nff.surface({.color = {0.55, 0.4, 0.2}, .diffuse = 1, .specular = 0});
  Tree(nff).grow(size, {}, 1);
}

}  // namespace kdray::generate
