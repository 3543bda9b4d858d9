// What    The closest point of the mesh to each of many, by rtcPointQuery, whose function has the distance to
//         a triangle.
// Source  Ericson, "Real-Time Collision Detection", 2005, 5.1.5: by the regions of the triangle's plane.
#include "base/vec.h"
#include "bench/embree/asker.h"

namespace kdray::bench::embree {

namespace {

struct Nearest {
  vec3 point;
  float u, v;  // weights of the second and third corner
};

Nearest nearest_of(const vec3& p, const vec3& a, const vec3& b, const vec3& c) {
  const vec3 ab = b - a, ac = c - a, ap = p - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, 0, 0};
  const vec3 bp = p - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, 1, 0};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const float u = d1 / (d1 - d3);
    return {a + u * ab, u, 0};
  }
  const vec3 cp = p - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, 0, 1};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const float v = d2 / (d2 - d6);
    return {a + v * ac, 0, v};
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const float v = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + v * (c - b), 1 - v, v};
  }
  const float unit = 1 / (va + vb + vc), u = vb * unit, v = vc * unit;
  return {a + u * ab + v * ac, u, v};
}

struct Search {
  const MeshArrays* mesh;
  float distance = kInfinity;
  std::uint32_t geometry = kNoGeometry, primitive = kNoPrimitive;
  Nearest nearest{vec3(kInfinity), 0, 0};
};

vec3 corner(const MeshArrays& mesh, std::uint32_t triangle, int k) {
  const float* const v = &mesh.vertices[3 * mesh.triangles[3 * triangle + static_cast<std::uint32_t>(k)]];
  return {v[0], v[1], v[2]};
}

bool look_at_triangle(PointArguments* args) {
  Search& search = *static_cast<Search*>(args->user);
  const MeshArrays& mesh = *search.mesh;
  const vec3 p(args->query->x, args->query->y, args->query->z);
  const Nearest found = nearest_of(p, corner(mesh, args->primitive, 0), corner(mesh, args->primitive, 1),
                                   corner(mesh, args->primitive, 2));
  const float distance = glm::length(p - found.point);
  if (!(distance < search.distance)) return false;
  search.distance = args->query->radius = distance;
  search.geometry = args->geometry;
  search.primitive = args->primitive;
  search.nearest = found;
  return true;
}

}  // namespace

void nearest_points(Mesh& mesh, const QuerySet& set, std::size_t first, std::size_t n, Answers& a) {
  mesh.workers.run(n, [&](std::size_t, std::size_t begin, std::size_t end) {
    PointContext context;
    for (std::size_t i = first + begin; i < first + end; ++i) {
      Search search{&mesh.arrays};
      PointQuery query{set.points[3 * i], set.points[3 * i + 1], set.points[3 * i + 2], 0, kInfinity};
      mesh.plain.library().point_query(mesh.plain.get(), &query, &context, look_at_triangle, &search);
      a.t[i] = search.distance;
      a.geometry[i] = search.geometry;
      a.primitive[i] = search.primitive;
      a.u[i] = search.nearest.u;
      a.v[i] = search.nearest.v;
      for (int k = 0; k < 3; ++k) a.point[3 * i + static_cast<std::size_t>(k)] = search.nearest.point[k];
    }
  });
}

}  // namespace kdray::bench::embree
