// What    tree: a branch is a cone with a sphere on its end, from which two smaller branches grow.
// Shape   Size n: 2^(n+1) - 1 cones and as many spheres, 1 polygon, 7 lights.
// Source  Haines 1987, section "tree"; M. Aono and T. Kunii, IEEE CG&A 4(5), 1984.
#include <array>
#include <numbers>

#include "scene/generate/nff_writer.h"
#include "scene/generate/rotation.h"
#include "scene/generate/scenes.h"

namespace kdray::generate {

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
