// What    Boxes, closed cylinders and planes of JSON scenes: their first hits against those of the solid in
//         double, and that no ray gets in or out where a wall and its lid meet.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "pictures/render.h"

namespace kdray::test {
namespace {

Scene scene_of(const std::string& objects) {
  return Scene::from_memory(R"({"lights": [], "objects": [)" + objects + "]}", "s.json");
}

std::vector<Hit> hits_of(const Scene& scene, const std::vector<Ray>& rays) {
  Renderer renderer(scene, {}, device_of());
  return renderer.trace(rays);
}

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  dvec3 in_box(double side) { return {between(-side, side), between(-side, side), between(-side, side)}; }
  dvec3 direction() {
    for (;;) {
      const dvec3 v = in_box(1);
      const double length = glm::length(v);
      if (length > 0.01 && length < 1) return v / length;
    }
  }

 private:
  std::mt19937 engine_;
};

Ray ray_of(const dvec3& o, const dvec3& d) {
  Ray ray{};
  ray.t_max = INFINITY;
  for (int k = 0; k < 3; ++k)
    ray.origin[k] = static_cast<float>(o[k]), ray.direction[k] = static_cast<float>(d[k]);
  return ray;
}

dvec3 origin_of(const Ray& r) {
  return {r.origin[0], r.origin[1], r.origin[2]};
}
dvec3 direction_of(const Ray& r) {
  return {r.direction[0], r.direction[1], r.direction[2]};
}

// Where a line is in a truncated cone with its lids on: an interval of t. By the cone's quadratic and the two
// planes, the wall being single.
struct Solid {
  dvec3 base, apex;
  double r0, r1;

  bool holds(const dvec3& p, double slack) const {
    const dvec3 axis = apex - base;
    const double h = glm::length(axis), s = glm::dot(p - base, axis) / h;
    const double r = glm::length(p - base - axis * (s / h));
    return s > -slack && s < h + slack && r < r0 + (r1 - r0) * s / h + slack;
  }
  // The least t > 0 at which the ray crosses the surface.
  std::optional<double> first_hit(const dvec3& o, const dvec3& d) const {
    const dvec3 axis = apex - base, a = glm::normalize(axis);
    const double h = glm::length(axis), k = (r1 - r0) / h;
    std::vector<double> ts;
    const double da = glm::dot(d, a), oa = glm::dot(o - base, a);
    const dvec3 dp = d - a * da, op = o - base - a * oa;
    const double A = glm::dot(dp, dp) - k * k * da * da, B = glm::dot(dp, op) - k * da * (r0 + k * oa),
                 C = glm::dot(op, op) - (r0 + k * oa) * (r0 + k * oa);
    if (const double root = B * B - A * C; root >= 0 && A != 0)
      for (const double t : {(-B - std::sqrt(root)) / A, (-B + std::sqrt(root)) / A}) {
        const double s = oa + t * da;
        if (s >= 0 && s <= h && r0 + k * s >= 0) ts.push_back(t);
      }
    for (const auto& [s, r] : {std::pair{0.0, r0}, {h, r1}}) {
      const double t = (s - oa) / da;
      if (glm::length(op + dp * t) <= r) ts.push_back(t);
    }
    std::optional<double> first;
    for (const double t : ts)
      if (t > 0 && (!first || t < *first)) first = t;
    return first;
  }
};

std::string text_of(const Solid& s) {
  return fmt::format(
      R"({{"type": "cylinder", "base": [{}, {}, {}], "apex": [{}, {}, {}],
           "radius": {}, "apex_radius": {}}})",
      s.base.x, s.base.y, s.base.z, s.apex.x, s.apex.y, s.apex.z, s.r0, s.r1);
}

std::vector<Solid> solids(Draw& draw) {
  std::vector<Solid> all{{{0, -1, 0}, {0, 1, 0}, 1, 1}, {{0, 0, 0}, {0, 0, 3}, 2, 0}};
  for (int i = 0; i < 12; ++i)
    all.push_back(
        {draw.in_box(2), draw.in_box(2), draw.between(0.1, 2), i % 3 == 0 ? 0.0 : draw.between(0.1, 2)});
  return all;
}

TEST(Solids, FirstHitsOfClosedCylindersAreTheSolids) {
  Draw draw(11);
  for (const Solid& solid : solids(draw)) {
    SCOPED_TRACE(text_of(solid));
    std::vector<Ray> rays;
    for (int i = 0; i < 4000; ++i) rays.push_back(ray_of(draw.in_box(6), draw.direction()));
    const std::vector<Hit> hits = hits_of(scene_of(text_of(solid)), rays);
    int apart = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto wanted = solid.first_hit(origin_of(rays[i]), direction_of(rays[i]));
      const bool hit = hits[i].primitive >= 0;
      apart += hit != wanted.has_value() ||
               (hit && std::abs(static_cast<double>(hits[i].t) - *wanted) > 1e-3 * std::max(1.0, *wanted));
    }
    EXPECT_LE(apart, 6) << "of 4000, where they pass an edge or graze";
  }
}

// A ray from within meets the solid whatever it aims at, be it the rim itself.
TEST(Solids, NothingGetsOutOfAClosedCylinder) {
  Draw draw(12);
  for (const Solid& solid : solids(draw)) {
    SCOPED_TRACE(text_of(solid));
    const dvec3 axis = solid.apex - solid.base, a = glm::normalize(axis);
    const dvec3 u = glm::normalize(glm::cross(a, std::abs(a.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0)));
    const dvec3 v = glm::cross(a, u);
    std::vector<Ray> rays;
    while (rays.size() < 60000) {
      const double s = draw.between(0.05, 0.95), r = 0.95 * (solid.r0 + (solid.r1 - solid.r0) * s);
      const double phi = draw.between(0, 2 * std::numbers::pi), theta = draw.between(0, 2 * std::numbers::pi);
      const dvec3 from =
          solid.base + axis * s + (u * std::cos(phi) + v * std::sin(phi)) * (r * draw.between(0, 1));
      const bool at_apex = rays.size() % 2 == 0;
      const dvec3 rim = (at_apex ? solid.apex : solid.base) +
                        (u * std::cos(theta) + v * std::sin(theta)) * (at_apex ? solid.r1 : solid.r0);
      const double off = std::exp2(draw.between(-30, -10));  // beside the rim, less and less
      const dvec3 to = rim + draw.direction() * off;
      if (!solid.holds(from, 0)) continue;
      rays.push_back(ray_of(from, to - from));
    }
    // Something far off makes the scene larger, and with it what floats tell apart.
    for (const char* const far : {"", R"(, {"type": "sphere", "center": [0, 400, 0], "radius": 1})"}) {
      const std::vector<Hit> hits = hits_of(scene_of(text_of(solid) + far), rays);
      std::size_t out = 0;
      for (const Hit& hit : hits) out += hit.primitive < 0 || hit.primitive > 2 ? 1 : 0;
      EXPECT_EQ(out, 0u) << far;
    }
  }
}

TEST(Solids, BoxesAreClosedAndWhereTheyAre) {
  Draw draw(13);
  const dvec3 lo(-1, 0.25, -0.5), hi(2, 1, 0.75);
  const Scene scene = scene_of(R"({"type": "box", "min": [2, 0.25, -0.5], "max": [-1, 1, 0.75]})");
  EXPECT_EQ(scene.primitives(), 12u);
  std::vector<Ray> rays;
  for (int i = 0; i < 20000; ++i) rays.push_back(ray_of(draw.in_box(4), draw.direction()));
  for (int i = 0; i < 20000; ++i) {
    const dvec3 from{draw.between(-1, 2), draw.between(0.25, 1), draw.between(-0.5, 0.75)};
    const dvec3 corner{i & 1 ? lo.x : hi.x, i & 2 ? lo.y : hi.y, i & 4 ? lo.z : hi.z};
    rays.push_back(ray_of(from, corner - from));  // at corners, from within
  }
  const std::vector<Hit> hits = hits_of(scene, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const dvec3 o = origin_of(rays[i]), d = direction_of(rays[i]);
    double enter = -INFINITY, leave = INFINITY;
    for (int k = 0; k < 3; ++k) {
      const double t0 = (lo[k] - o[k]) / d[k], t1 = (hi[k] - o[k]) / d[k];
      enter = std::max(enter, std::min(t0, t1)), leave = std::min(leave, std::max(t0, t1));
    }
    const bool wanted = enter <= leave && leave > 0;
    const double t = enter > 0 ? enter : leave;
    if (std::abs(enter - leave) < 1e-4) continue;  // past an edge
    ASSERT_EQ(hits[i].primitive >= 0, wanted) << i;
    if (!wanted) continue;
    ASSERT_NEAR(hits[i].t, t, 1e-4 * std::max(1.0, t)) << i;
  }
}

// A picture from above a plane: all below the horizon is plane, all above it is not, and what stands on it is
// seen as exactly as without.
TEST(Solids, APlaneReachesTheHorizon) {
  const Scene scene = Scene::from_memory(
      R"({"camera": {"from": [0, 1, 5], "at": [0, 1, 0], "fov": 90}, "lights": [], "objects": [
          {"type": "plane", "point": [3, 0, 1], "normal": [0, 2, 0], "material": {"emission": 1, "ka": 0}},
          {"type": "sphere", "center": [0, 0.5, 0], "radius": 0.5,
           "material": {"emission": 0.5, "ka": 0}}]})",
      "s.json");
  Renderer renderer(scene, {}, device_of());
  const Picture picture = renderer.render(exact_options(65, 100, 1));
  for (std::size_t y = 0; y < 100; ++y) {
    const float edge = picture.rgb[3 * (y * 65)];
    if (y == 49 || y == 50) continue;  // the horizon
    EXPECT_EQ(edge, y > 50 ? 1 : 0) << y;
  }
  EXPECT_EQ(picture.rgb[3 * (53 * 65 + 32)], 0.5f);
}

TEST(Solids, APlaneMayBeGivenItsExtent) {
  const Scene scene = scene_of(R"({"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "extent": 3})");
  const std::vector<Hit> hits =
      hits_of(scene, {ray_of({2.9, 0, 1}, {0, 0, -1}), ray_of({3.1, 0, 1}, {0, 0, -1})});
  EXPECT_EQ(hits[0].primitive, 0);
  EXPECT_LT(hits[1].primitive, 0);
}

}  // namespace
}  // namespace kdray::test
