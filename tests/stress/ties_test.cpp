// Triangles that overlap in one plane: wherever several are hit, the one with the lowest number is, whatever
// the others' shape and order, in every traversal. Coinciding triangles in any plane; overlapping ones in
// planes across the axes.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "scene/model/scene.h"
#include "stress/random.h"
#include "stress/table.h"
#include "stress/traced.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 600;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
using Corners = std::array<vec3, 3>;

scene::Scene of(const std::vector<Corners>& triangles) {
  scene::Scene s;
  s.camera = scene::Camera{};
  for (const Corners& corners : triangles) {
    scene::Triangle t;
    t.material = t.number = s.primitive_count();
    for (std::size_t k = 0; k < 3; ++k) {
      t.vertex[k] = static_cast<std::uint32_t>(s.vertices.size());
      s.vertices.push_back(dvec3(corners[k]));
    }
    s.triangles.push_back(t);
    s.materials.emplace_back();
  }
  return s;
}

// 1: surely inside, -1: surely outside, 0: too near to an edge to tell.
int side(const Corners& t, const dvec3& p, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  double least = 1e30, most = -1e30;
  for (std::size_t k = 0; k < 3; ++k) {
    const dvec3 a(t[k]), b(t[(k + 1) % 3]);
    const double length = std::hypot(b[x] - a[x], b[y] - a[y]);
    const double w = ((b[x] - a[x]) * (p[y] - a[y]) - (b[y] - a[y]) * (p[x] - a[x])) / length;
    least = std::min(least, w), most = std::max(most, w);
  }
  const double inside = std::max(least, -most);
  return inside > 1e-4 ? 1 : (inside < -1e-4 ? -1 : 0);
}

class Ties : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
  }
};

Ray ray_at(const dvec3& target, Random& random) {
  const vec3 origin(target + random.uniform(1, 10) * random.direction()), d(target - dvec3(origin));
  return {{origin.x, origin.y, origin.z}, 0, {d.x, d.y, d.z}, kInfinity};
}

TEST_P(Ties, OverlappingInAPlaneAcrossAnAxis) {
  const int axis = GetParam();
  for (const float height : {0.0f, 1.0f, 0.7f, -123.456f}) {
    std::vector<Corners> triangles;
    for (std::uint64_t i = 0; i < 48; ++i) {
      Random random(kSeed + static_cast<std::uint64_t>(axis), i);
      Corners t;
      for (vec3& v : t)
        for (int k = 0; k < 3; ++k) v[k] = k == axis ? height : static_cast<float>(random.uniform(-1, 1));
      triangles.push_back(t);
    }
    Tally tally("ties",
                std::string("overlapping, plane across ") + "xyz"[axis] + " at " + std::to_string(height));
    Renderer renderer(Scene{of(triangles)});
    const auto target = [&](Random& random) {
      dvec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      p[axis] = height;
      return p;
    };
    const auto make = [&](std::uint64_t i) {
      Random random(kSeed + 10, i);
      return ray_at(target(random), random);
    };
    const auto wrong = [&](std::uint64_t, const Ray& ray, const Hit& hit) {
      if (ray.direction[axis] == 0)
        return hit.primitive >= 0;  // in the plane: triangles seen edge-on are not met
      const double t = (static_cast<double>(height) - ray.origin[axis]) / ray.direction[axis];
      const dvec3 p = dvec3(ray.origin[0], ray.origin[1], ray.origin[2]) +
                      t * dvec3(ray.direction[0], ray.direction[1], ray.direction[2]);
      for (int n = 0; n < static_cast<int>(triangles.size()); ++n) {
        const int in = side(triangles[static_cast<std::size_t>(n)], p, axis);
        if (in == 0) return false;  // not to be told
        if (in > 0) return hit.primitive != n;
      }
      return hit.primitive >= 0;
    };
    trace_all(renderer, 0, rays_to_trace(0.002), make, wrong, tally);
    tally.publish();
    EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed << ", " << tally.first_wrong;
    EXPECT_EQ(tally.differing, 0) << tally.first_differing;
  }
}
INSTANTIATE_TEST_SUITE_P(Axis, Ties, testing::Values(0, 1, 2));

// The same three corners again and again, and in the order that the other side is seen in.
TEST_F(Ties, CoincidingInAnyPlane) {
  std::vector<Corners> triangles;
  for (std::uint64_t i = 0; i < 64; ++i) {
    Random random(kSeed + 20, i % 16);
    Corners t;
    for (vec3& v : t) v = vec3(random.direction());
    triangles.push_back(t);
  }
  Tally tally("ties", "coinciding, any plane");
  Renderer renderer(Scene{of(triangles)});
  const auto make = [&](std::uint64_t i) {
    Random random(kSeed + 21, i);
    return ray_at(0.9 * random.direction(), random);
  };
  const auto wrong = [](std::uint64_t, const Ray&, const Hit& hit) { return hit.primitive >= 16; };
  trace_all(renderer, 0, rays_to_trace(0.004), make, wrong, tally);
  tally.publish();
  EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed << ", " << tally.first_wrong;
  EXPECT_EQ(tally.differing, 0) << tally.first_differing;
}

}  // namespace
}  // namespace kdray::stress
