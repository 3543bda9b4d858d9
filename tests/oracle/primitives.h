// What    The oracle's geometry: every primitive of a scene in double precision, and brute force over all of
//         them. Deliberately plain, and deliberately apart from kdray's own code: no tree, no boxes, no
//         float, the textbook formula of each shape.
// Shape   Primitives are named by Scene's own numbers (file order).
// Units   World units; t in multiples of Ray::direction.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::oracle {

inline constexpr int kNothing = -1;

struct Ray {
  dvec3 origin{0};
  dvec3 direction{0, 0, -1};
  double t_min = 0;
  double t_max = std::numeric_limits<double>::infinity();
  int self = kNothing;  // the primitive the origin lies on: its hit at t = 0 is no hit
};

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  int primitive = kNothing;
  double u = 0, v = 0;  // triangle: weights of the 2nd and 3rd corner; cone: u = 0 base to 1 apex
  bool found() const { return primitive != kNothing; }
};

// What shading needs to know about a hit.
struct Surface {
  dvec3 point{0};
  dvec3 outward{0, 0, 1};  // geometric normal, unit: a triangle's front, the outside of a sphere or a cone
  dvec3 shading{0, 0,
                1};  // interpolated where there are vertex normals, else `outward`; unit, not flipped either
  bool smooth = false;                    // has vertex normals
  dvec3 corner[3]{}, corner_normal[3]{};  // of a smooth triangle
  double weight[3]{};                     // barycentric
  std::uint32_t material = 0;
};

// A primitive in double; which of the numbers are set, and what for, is its kind's affair.
struct Shape {
  primitives::PrimitiveKind kind{};
  std::uint32_t source = 0;  // index into the scene's array of that kind
  int number = 0;
  dvec3 a{0}, b{0}, c{0};
  double r0 = 0, r1 = 0;
  dvec3 normal{0};
};

// Each kind has these (tests/primitives/<kind>.cpp): the shape of one, but for the first three members, or
// none where there is nothing to hit, with `box` grown by it; where a ray meets it first, as World::closest()
// has it; and what there is at a hit but for the point and the material.
#define KDRAY_ORACLE_OF_KIND(NAME, name, names, Struct)                                                     \
  std::optional<Shape> shape_of(const scene::Scene& scene, const scene::Struct& name, DBox& box);           \
  Hit intersect(primitives::Struct##Kind, const Shape& shape, const Ray& ray, double grow);                 \
  void put_surface(primitives::Struct##Kind, const scene::Scene& scene, const Shape& shape, const Hit& hit, \
                   Surface& out);
KDRAY_KINDS(KDRAY_ORACLE_OF_KIND)
#undef KDRAY_ORACLE_OF_KIND

inline bool within(double t, const Ray& ray) {
  return t >= ray.t_min && t <= ray.t_max;
}

class World {
 public:
  explicit World(const scene::Scene& scene);

  // The closest hit within [t_min, t_max]; of equal t's the smaller number. All surfaces are moved outward
  // over their edges and radii by `grow` (negative: inward), a length: what both a grown and a shrunk world
  // hit, no rounding of that size can miss.
  Hit closest(const Ray& ray, double grow = 0) const;
  // Whether anything lies strictly within (t_min, t_max).
  bool occluded(const Ray& ray) const;
  Surface surface(const Ray& ray, const Hit& hit) const;

  double extent() const { return extent_; }  // the largest coordinate's magnitude about the scene's centre
  std::size_t size() const { return shapes_.size(); }

 private:
  const scene::Scene& scene_;
  std::vector<Shape> shapes_;  // ascending numbers
  double extent_ = 0;
};

}  // namespace kdray::oracle
