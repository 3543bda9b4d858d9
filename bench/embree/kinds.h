// What    What each kind of primitive is in Embree: its type, and its buffers, as a scene that is traced has
//         them and as those that builds are measured by are filled beforehand.
// Shape   Triangles are triangles, spheres SPHERE_POINTs, cones CONE_LINEAR_CURVEs whose segments are flagged
//         as having neighbours, which leaves the end caps off, discs ORIENTED_DISC_POINTs. A kind that has no
//         type here is none of Embree's: a scene with it is refused.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/embree/library.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::bench::embree {

// A curve's flags without end caps.
inline constexpr std::uint8_t kOpenCone = kNeighborLeft | kNeighborRight;

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

template <class Kind>
constexpr bool kEmbreeHas = embree_type(Kind()) != GeometryType::user;

template <class Kind>
void refuse_any(Kind, const scene::Geometry& geometry) {
  if (!Kind::of(geometry).empty())
    throw Error(ErrorCode::input, std::string("Embree has no ") + Kind::kNames +
                                      ": leave them out of a scene that it is to trace");
}

// ---- Of a scene that is traced

template <class T>
T* new_buffer(const Library& embree, Geometry g, BufferType type, Format format, std::size_t stride,
              std::size_t n) {
  void* const memory = embree.set_new_geometry_buffer(g, type, 0, format, stride, n);
  if (memory == nullptr) throw Error(ErrorCode::out_of_memory, "no memory for Embree's copy of the scene");
  return static_cast<T*>(memory);
}

inline void fill(const Library& embree, Geometry g, std::span<const scene::TriangleGeometry> triangles) {
  auto* point =
      new_buffer<vec3>(embree, g, BufferType::vertex, Format::float3, sizeof(vec3), 3 * triangles.size());
  auto* index = new_buffer<std::uint32_t>(embree, g, BufferType::index, Format::uint3,
                                          3 * sizeof(std::uint32_t), triangles.size());
  for (const scene::TriangleGeometry& t : triangles)
    for (int i = 0; i < 3; ++i) *point++ = scene::vertex(t, i);
  for (std::uint32_t i = 0; i < 3 * triangles.size(); ++i) index[i] = i;
}

inline void fill(const Library& embree, Geometry g, const std::vector<scene::SphereGeometry>& spheres) {
  auto* point =
      new_buffer<glm::vec4>(embree, g, BufferType::vertex, Format::float4, sizeof(glm::vec4), spheres.size());
  for (const scene::SphereGeometry& s : spheres) *point++ = {s.center, s.radius};
}

inline void fill(const Library& embree, Geometry g, const std::vector<scene::ConeGeometry>& cones) {
  auto* point = new_buffer<glm::vec4>(embree, g, BufferType::vertex, Format::float4, sizeof(glm::vec4),
                                      2 * cones.size());
  auto* index = new_buffer<std::uint32_t>(embree, g, BufferType::index, Format::uint, sizeof(std::uint32_t),
                                          cones.size());
  auto* flags = new_buffer<std::uint8_t>(embree, g, BufferType::flags, Format::uchar, 1, cones.size());
  for (std::uint32_t i = 0; i < cones.size(); ++i) {
    point[2 * i] = {cones[i].base, cones[i].base_radius};
    point[2 * i + 1] = {cones[i].apex, cones[i].apex_radius};
    index[i] = 2 * i;
    flags[i] = kOpenCone;
  }
}

inline void fill(const Library& embree, Geometry g, const std::vector<scene::DiscGeometry>& discs) {
  auto* point =
      new_buffer<glm::vec4>(embree, g, BufferType::vertex, Format::float4, sizeof(glm::vec4), discs.size());
  auto* normal = new_buffer<vec3>(embree, g, BufferType::normal, Format::float3, sizeof(vec3), discs.size());
  for (const scene::DiscGeometry& d : discs) *point++ = {d.center, d.radius}, *normal++ = d.normal;
}

// ---- For builds

// Embree reads vectors of 16 bytes, at the end too.
inline constexpr std::size_t kPadding = 16 / sizeof(float);

struct Buffers {
  std::vector<float> vertices;  // of 3 (triangles) or 4 (with a radius) floats
  std::size_t n_vertices = 0;
  std::vector<float> normals;  // of 3
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> flags;
};

// The buffers of a kind.
inline Buffers buffers_of(primitives::TriangleKind, const scene::Scene& scene,
                          const scene::Geometry& geometry) {
  Buffers b;
  if (geometry.triangles.empty()) return b;
  b.vertices.reserve(3 * scene.vertices.size() + kPadding);
  for (const dvec3& v : scene.vertices) {
    const vec3 local(geometry.space.local(v));
    b.vertices.insert(b.vertices.end(), {local.x, local.y, local.z});
  }
  b.indices.reserve(3 * geometry.triangles.size());
  for (const std::uint32_t source : geometry.sources)
    for (const std::uint32_t v : scene.triangles[source].vertex) b.indices.push_back(v);
  b.n_vertices = scene.vertices.size();
  b.vertices.resize(b.vertices.size() + kPadding);
  return b;
}

inline void add_point(Buffers& b, const vec3& p, float radius) {
  b.vertices.insert(b.vertices.end(), {p.x, p.y, p.z, radius});
  ++b.n_vertices;
}

inline Buffers buffers_of(primitives::SphereKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::SphereGeometry& s : geometry.spheres) add_point(b, s.center, s.radius);
  return b;
}

inline Buffers buffers_of(primitives::ConeKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::ConeGeometry& c : geometry.cones) {
    b.indices.push_back(static_cast<std::uint32_t>(b.n_vertices));
    b.flags.push_back(kOpenCone);
    add_point(b, c.base, c.base_radius);
    add_point(b, c.apex, c.apex_radius);
  }
  return b;
}

inline Buffers buffers_of(primitives::DiscKind, const scene::Scene&, const scene::Geometry& geometry) {
  Buffers b;
  for (const scene::DiscGeometry& d : geometry.discs) {
    add_point(b, d.center, d.radius);
    b.normals.insert(b.normals.end(), {d.normal.x, d.normal.y, d.normal.z});
  }
  if (!b.normals.empty()) b.normals.resize(b.normals.size() + kPadding);
  return b;
}

template <class Kind>
Buffers buffers_of(Kind kind, const scene::Scene&, const scene::Geometry& geometry) {
  static_assert(!kEmbreeHas<Kind>);
  refuse_any(kind, geometry);
  return {};
}

}  // namespace kdray::bench::embree
