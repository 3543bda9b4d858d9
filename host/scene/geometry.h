// What    The primitives as the tree and the kernels see them: float, about the scene's own centre. The move is done
//         in double (DESIGN.md section 6), so that a model at (1e6, 1e6, 1e6) keeps its bits.
// Shape   One array per kind, in file order; `number` maps back to the file. Degenerate triangles (zero area after
//         rounding, exactly decided) and spheres or cones whose radius rounds to 0 are dropped and counted.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/raw_vector.h"
#include "math/box.h"
#include "scene/scene.h"

namespace kdray::scene {

enum class PrimitiveKind : std::uint32_t { triangle = 0, sphere = 1, cone = 2 };

struct TriangleGeometry {
  std::array<vec3, 3> vertex;
  std::uint32_t source;  // index into Scene::triangles
};
struct SphereGeometry {
  vec3 center;
  float radius;
  std::uint32_t source;  // index into Scene::spheres
};
struct ConeGeometry {
  vec3 base, apex;
  float base_radius, apex_radius;
  std::uint32_t source;  // index into Scene::cones
};

struct Geometry {
  dvec3 center{0};  // world = local + center
  RawVector<TriangleGeometry> triangles;
  std::vector<SphereGeometry> spheres;
  std::vector<ConeGeometry> cones;
  Box bounds;  // contains every primitive
  std::uint32_t dropped_degenerate = 0;

  std::size_t size() const { return triangles.size() + spheres.size() + cones.size(); }
};

Geometry make_geometry(const Scene& scene);

// Bounds that contain the primitive, rounded outward.
Box bounds_of(const TriangleGeometry& t);
Box bounds_of(const SphereGeometry& s);
Box bounds_of(const ConeGeometry& c);

}  // namespace kdray::scene
