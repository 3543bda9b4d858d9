// What    What each kind of primitive is in Embree: its type, and the buffers that Embree shares.
// Shape   Triangles are triangles, indexed as the scene has them, spheres SPHERE_POINTs, cones
//         CONE_LINEAR_CURVEs whose segments are flagged as having neighbours, which leaves the end caps off,
//         discs ORIENTED_DISC_POINTs. A kind that has no type here is none of Embree's.
// Errors  ErrorCode::input for a scene with such a kind.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/embree/library.h"
#include "bench/workload/arrays.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::bench::embree {

template <class Kind>
constexpr GeometryType embree_type(Kind) {
  return GeometryType::user;  // never made
}
constexpr GeometryType embree_type(primitives::TriangleKind) {
  return GeometryType::triangle;
}
constexpr GeometryType embree_type(primitives::SphereKind) {
  return GeometryType::sphere_point;
}
constexpr GeometryType embree_type(primitives::ConeKind) {
  return GeometryType::cone_linear_curve;
}
constexpr GeometryType embree_type(primitives::DiscKind) {
  return GeometryType::oriented_disc_point;
}

struct Buffers {
  std::vector<float> vertices;  // of 3 (triangles) or 4 (with a radius) floats
  std::size_t n_vertices = 0;
  std::vector<float> normals;  // of 3
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> flags;
};
using KindBuffers = std::array<Buffers, primitives::kKinds>;  // by the kinds' numbers

KindBuffers buffers_of(const scene::Scene& scene, const scene::Geometry& geometry);
KindBuffers buffers_of(const MeshArrays& mesh);

// Gives them to a geometry of that kind.
void share(const Library& embree, Geometry geometry, const Buffers& buffers, bool is_shape);

}  // namespace kdray::bench::embree
