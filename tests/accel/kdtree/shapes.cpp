#include "accel/kdtree/shapes.h"

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
  primitives::for_each_kind(
      [&](auto kind) { add_primitives(kind, g, random, kind.kIsShape ? n / 2 : n, size); });
  return g;
}

}  // namespace kdray::test
