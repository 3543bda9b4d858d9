#include "kdtree/shapes.h"

#include <cmath>

namespace kdray::test {

float uniform(Random& random, float lo, float hi) {
  return std::uniform_real_distribution<float>(lo, hi)(random);
}

vec3 random_vec3(Random& random, float lo, float hi) {
  vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = std::round(uniform(random, lo, hi) * 65536) / 65536;
  return v;
}

void add_triangle(scene::Geometry& g, const vec3& a, const vec3& b, const vec3& c) {
  const auto n = static_cast<std::uint32_t>(g.triangles.size());
  // An array's size is fixed: the geometry has that of a vector, which grows.
  using Triangles = std::vector<scene::TriangleGeometry>;
  const auto grown =
      n > 0 ? std::static_pointer_cast<Triangles>(g.triangles.owner()) : std::make_shared<Triangles>();
  grown->push_back({{{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}}, n, 0, KDRAY_NO_NORMALS});
  g.triangles = {grown, grown->data(), grown->size()};
  g.sources.push_back(n);
}

void add_triangles(scene::Geometry& g, Random& random, int n, float size) {
  for (int i = 0; i < n; ++i) {
    const vec3 c = random_vec3(random, -8, 8);
    add_triangle(g, c + random_vec3(random, -size, size), c + random_vec3(random, -size, size),
                 c + random_vec3(random, -size, size));
  }
}

void add_spheres(scene::Geometry& g, Random& random, int n, float size) {
  for (int i = 0; i < n; ++i)
    g.spheres.push_back({random_vec3(random, -8, 8), uniform(random, 0.01f * size, size),
                         static_cast<std::uint32_t>(g.spheres.size())});
}

void add_cones(scene::Geometry& g, Random& random, int n, float size) {
  for (int i = 0; i < n; ++i) {
    const vec3 base = random_vec3(random, -8, 8);
    vec3 apex = base + random_vec3(random, -size, size);
    if (apex == base) apex.x += size;
    // Some cones are pointed, some tapered, and some are cylinders.
    const float apex_radius = i % 3 == 0 ? 0 : uniform(random, 0, size);
    const float base_radius = i % 5 == 1 ? apex_radius + 0.01f : uniform(random, 0.01f, size);
    g.cones.push_back({base, apex, base_radius, i % 5 == 1 ? base_radius : apex_radius,
                       static_cast<std::uint32_t>(g.cones.size())});
  }
}

void add_architecture(scene::Geometry& g, Random& random, int n) {
  const auto whole = [&](int lo, int hi) {
    return static_cast<float>(std::uniform_int_distribution<int>(lo, hi)(random));
  };
  for (int i = 0; i < n; ++i) {
    const int axis = i % 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
    vec3 corner{whole(-8, 8), whole(-8, 8), whole(-8, 8)}, du{0}, dv{0};
    du[u] = whole(1, 6);
    dv[v] = whole(1, 6);
    add_triangle(g, corner, corner + du, corner + du + dv);
    add_triangle(g, corner, corner + du + dv, corner + dv);
  }
}

scene::Geometry mixed_geometry(Random& random, int n, float size) {
  scene::Geometry g;
  add_triangles(g, random, n, size);
  add_spheres(g, random, n / 2, size);
  add_cones(g, random, n / 2, size);
  return g;
}

}  // namespace kdray::test
