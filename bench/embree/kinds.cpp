#include "bench/embree/kinds.h"

#include <string>

#include "base/error.h"

namespace kdray::bench::embree {

namespace {

constexpr std::uint8_t kOpenCone = kNeighborLeft | kNeighborRight;  // a curve's flags without end caps
// Embree reads vectors of 16 bytes, at the end too.
constexpr std::size_t kPadding = 16 / sizeof(float);

void add_point(Buffers& b, const vec3& p, float radius) {
  b.vertices.insert(b.vertices.end(), {p.x, p.y, p.z, radius});
  ++b.n_vertices;
}

void fill(Buffers& b, primitives::TriangleKind, const scene::Scene& scene, const scene::Geometry& geometry) {
  if (geometry.triangles.empty()) return;
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
}

void fill(Buffers& b, primitives::SphereKind, const scene::Scene&, const scene::Geometry& geometry) {
  for (const scene::SphereGeometry& s : geometry.spheres) add_point(b, s.center, s.radius);
}

void fill(Buffers& b, primitives::ConeKind, const scene::Scene&, const scene::Geometry& geometry) {
  for (const scene::ConeGeometry& c : geometry.cones) {
    b.indices.push_back(static_cast<std::uint32_t>(b.n_vertices));
    b.flags.push_back(kOpenCone);
    add_point(b, c.base, c.base_radius);
    add_point(b, c.apex, c.apex_radius);
  }
}

void fill(Buffers& b, primitives::DiscKind, const scene::Scene&, const scene::Geometry& geometry) {
  for (const scene::DiscGeometry& d : geometry.discs) {
    add_point(b, d.center, d.radius);
    b.normals.insert(b.normals.end(), {d.normal.x, d.normal.y, d.normal.z});
  }
  if (!b.normals.empty()) b.normals.resize(b.normals.size() + kPadding);
}

template <class Kind>
void fill(Buffers&, Kind kind, const scene::Scene&, const scene::Geometry& geometry) {
  static_assert(embree_type(Kind()) == GeometryType::user);
  if (!kind.of(geometry).empty())
    throw Error(ErrorCode::input, std::string("Embree has no ") + kind.kNames +
                                      ": leave them out of a scene that it is to trace");
}

}  // namespace

KindBuffers buffers_of(const scene::Scene& scene, const scene::Geometry& geometry) {
  KindBuffers all;
  primitives::for_each_kind([&](auto kind) { fill(all[kind.kNumber], kind, scene, geometry); });
  return all;
}

KindBuffers buffers_of(const MeshArrays& mesh) {
  KindBuffers all;
  Buffers& b = all[primitives::TriangleKind::kNumber];
  b.vertices.reserve(mesh.vertices.size() + kPadding);
  b.vertices = mesh.vertices;
  b.n_vertices = mesh.vertices.size() / 3;
  b.indices = mesh.triangles;
  b.vertices.resize(b.vertices.size() + kPadding);
  return all;
}

void share(const Library& embree, Geometry geometry, const Buffers& b, bool is_shape) {
  const auto give = [&](BufferType type, Format format, const auto& values, std::size_t of_each,
                        std::size_t n) {
    if (n > 0)
      embree.set_shared_geometry_buffer(geometry, type, 0, format, values.data(), 0,
                                        of_each * sizeof values[0], n);
  };
  give(BufferType::vertex, is_shape ? Format::float4 : Format::float3, b.vertices, is_shape ? 4 : 3,
       b.n_vertices);
  give(BufferType::normal, Format::float3, b.normals, 3, b.normals.empty() ? 0 : b.n_vertices);
  if (is_shape)
    give(BufferType::index, Format::uint, b.indices, 1, b.indices.size());
  else
    give(BufferType::index, Format::uint3, b.indices, 3, b.indices.size() / 3);
  give(BufferType::flags, Format::uchar, b.flags, 1, b.flags.size());
}

}  // namespace kdray::bench::embree
