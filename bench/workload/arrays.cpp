#include "bench/workload/arrays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 3> kSetNames{"coherent", "diffuse", "random"};

void append(std::vector<float>& to, const float (&v)[3]) {
  to.insert(to.end(), {v[0], v[1], v[2]});
}

QuerySet set_of(const RayClass& rays, std::size_t n) {
  QuerySet set{rays.name == "primary" ? "coherent" : rays.name, {}, {}, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const Ray& ray = rays.rays[i % rays.rays.size()];
    append(set.origins, ray.origin);
    append(set.directions, ray.direction);
  }
  set.points = set.origins;
  return set;
}

// Eye rays begin at one place, where points would all be the same.
void move_half_way(const Tracer& trace, float width, QuerySet& set) {
  const std::vector<Hit> hits = trace(set.structs());
  for (std::size_t i = 0; i < set.points.size(); ++i) {
    const float t = hits[i / 3].t;
    set.points[i] += 0.5f * (std::isfinite(t) ? t : width) * set.directions[i];
  }
}

}  // namespace

MeshArrays mesh_of(const scene::Scene& scene, const std::string& name) {
  if (scene.triangles.empty())
    throw Error(ErrorCode::input, name + ": it has no triangles to hand over; give a scene of meshes");
  MeshArrays mesh;
  for (const dvec3& v : scene.vertices)
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(static_cast<float>(v[k]));
  for (const scene::Triangle& t : scene.triangles)
    mesh.triangles.insert(mesh.triangles.end(), t.vertex.begin(), t.vertex.end());
  return mesh;
}

std::vector<Ray> QuerySet::structs() const {
  std::vector<Ray> rays(size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    std::copy_n(&origins[3 * i], 3, rays[i].origin);
    std::copy_n(&directions[3 * i], 3, rays[i].direction);
    rays[i].t_min = 0;
    rays[i].t_max = std::numeric_limits<float>::infinity();
  }
  return rays;
}

std::span<const std::string_view> set_names() {
  return kSetNames;
}

std::vector<QuerySet> make_sets(const scene::Scene& scene, std::span<const std::string> names, std::size_t n,
                                const Tracer& trace) {
  std::vector<std::string> classes;
  for (const std::string& name : names) classes.push_back(name == "coherent" ? "primary" : name);
  // The tracer numbers triangles as they lie in the mesh.
  const Tracer by_number = [&](std::span<const Ray> rays) {
    std::vector<Hit> hits = trace(rays);
    for (Hit& hit : hits)
      if (hit.primitive >= 0)
        hit.primitive =
            static_cast<std::int32_t>(scene.triangles[static_cast<std::size_t>(hit.primitive)].number);
    return hits;
  };
  const auto width = static_cast<float>(glm::length(scene.bounds().extent()));
  std::vector<QuerySet> sets;
  for (const RayClass& c : make_classes(scene, classes, side_of(static_cast<int>(n)), by_number)) {
    if (c.rays.empty()) continue;
    sets.push_back(set_of(c, n));
    if (c.name == "primary") move_half_way(trace, width, sets.back());
  }
  return sets;
}

}  // namespace kdray::bench
