// Spheres in spheres a float step apart, spheres that touch, and the same sphere twice: the nearest by exact
// arithmetic is hit, the lower number where two are one. Excepted and counted: distances that differ by less
// than the error of a distance.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "scene/model/scene.h"
#include "stress/exact.h"
#include "stress/random.h"
#include "stress/table.h"
#include "stress/traced.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 6000;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Ball {
  vec3 center;
  float radius;
};

scene::Scene of(const std::vector<Ball>& balls) {
  scene::Scene s;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  for (const Ball& b : balls) s.spheres.push_back({dvec3(b.center), b.radius, 0, s.primitive_count()});
  return s;
}

struct Nearest {
  int ball = -1;
  double t = kInfinity;
};

// Of spheres at the same distance it is the one with the lowest number.
Nearest nearest(const std::vector<Ball>& balls, const Ray& ray) {
  Nearest best;
  Exact best_t;
  const Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const layout::Sphere s{
        {balls[i].center.x, balls[i].center.y, balls[i].center.z}, balls[i].radius, 0, 0, {}};
    for (const Exact& t : roots(o, d, s)) {
      if (sgn(t) <= 0 || (best.ball >= 0 && t >= best_t)) continue;
      best = {static_cast<int>(i), t.get_d()};
      best_t = t;
    }
  }
  return best;
}

class Spheres : public testing::Test {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no OpenCL device";
    set_precision();
  }

  template <class Make>
  void expect_nearest(const char* family, const std::vector<Ball>& balls, double reach, const Make& make) {
    Renderer renderer(Scene{of(balls)});
    Tally tally("spheres", family);
    std::uint64_t undecided = 0;
    const std::uint64_t n = is_full() ? 40000 : 4000;
    const std::vector<Ray> rays = make_rays(0, n, make);
    std::vector<Nearest> wanted(n);
    tbb::parallel_for(std::size_t{0}, rays.size(),
                      [&](std::size_t i) { wanted[i] = nearest(balls, rays[i]); });
    for (std::size_t i = 0; i < n; ++i) undecided += is_undecided(balls, rays[i], wanted[i], reach);
    const auto wrong = [&](std::uint64_t i, const Ray& ray, const Hit& hit) {
      return hit.primitive != wanted[i].ball && !is_undecided(balls, ray, wanted[i], reach);
    };
    trace_all(
        renderer, 0, n, [&](std::uint64_t i) { return rays[i]; }, wrong, tally);
    for (std::size_t w = 0; w < kWalks.size(); ++w) tally.row(w).exceptions = undecided;
    tally.publish();
    EXPECT_EQ(tally.wrong(), 0) << "seed " << kSeed << ", " << tally.first_wrong;
    EXPECT_EQ(tally.differing, 0) << tally.first_differing;
    EXPECT_LT(undecided, n / 2);
  }

  // The least t > -slack at which a sphere of this radius is met; inf where it is missed.
  static double first_root(const dvec3& f, const dvec3& d, double radius, double slack) {
    const double a = glm::dot(d, d), b = glm::dot(f, d),
                 h2 = (radius * radius - glm::dot(f, f) + b * b / a) / a;
    if (h2 < 0) return kInfinity;
    const double near = -b / a - std::sqrt(h2), far = -b / a + std::sqrt(h2);
    return near > -slack ? near : (far > -slack ? far : kInfinity);
  }

  // Whether another answer could be right if every radius were off by the error that float coordinates of
  // size `reach` bring.
  static bool is_undecided(const std::vector<Ball>& balls, const Ray& ray, const Nearest& wanted,
                           double reach) {
    const dvec3 o(ray.origin[0], ray.origin[1], ray.origin[2]),
        d(ray.direction[0], ray.direction[1], ray.direction[2]);
    const double error = 0x1p-21 * reach, slack = error / glm::length(d);
    const auto earliest = [&](const Ball& b) {
      const dvec3 f = o - dvec3(b.center);
      return std::min(first_root(f, d, b.radius + error, slack), first_root(f, d, b.radius - error, slack));
    };
    if (wanted.ball < 0)
      return std::any_of(balls.begin(), balls.end(), [&](const Ball& b) { return earliest(b) < kInfinity; });
    const Ball& met = balls[static_cast<std::size_t>(wanted.ball)];
    const dvec3 f = o - dvec3(met.center);
    // Where it may be hit at the latest, in so far as it is not missed.
    const double latest =
        std::max(first_root(f, d, met.radius + error, 0), first_root(f, d, met.radius - error, 0));
    if (wanted.t < 2 * slack || !(latest < kInfinity)) return true;
    return std::any_of(balls.begin(), balls.end(), [&](const Ball& b) {
      const bool same = b.center == met.center && b.radius == met.radius;
      return !same && earliest(b) <= latest + slack;
    });
  }
};

TEST_F(Spheres, ConcentricSeenFromOutside) {
  std::vector<Ball> balls;
  for (int i = 0; i < 16; ++i) balls.push_back({vec3(0.25f, -0.5f, 1), 1 + static_cast<float>(i) * 0x1p-14f});
  expect_nearest("concentric, from outside", balls, 8, [](std::uint64_t i) {
    Random random(kSeed, i);
    const vec3 o(dvec3(0.25, -0.5, 1) + random.uniform(2, 4) * random.direction());
    const vec3 d(dvec3(0.25, -0.5, 1) + random.uniform(0, 0.999) * random.direction() - dvec3(o));
    return Ray{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInfinity};
  });
}

TEST_F(Spheres, ConcentricSeenFromTheCentre) {
  std::vector<Ball> balls;
  for (int i = 15; i >= 0; --i) balls.push_back({vec3(0), 1 + static_cast<float>(i) * 0x1p-18f});
  expect_nearest("concentric, from the centre", balls, 1, [](std::uint64_t i) {
    Random random(kSeed + 1, i);
    const vec3 d(random.log_uniform(1e-3, 1e3) * random.direction());
    return Ray{{0, 0, 0}, 0, {d.x, d.y, d.z}, kInfinity};
  });
}

TEST_F(Spheres, TouchingEachOther) {
  const std::vector<Ball> balls{{vec3(-1, 0, 0), 1}, {vec3(1, 0, 0), 1}, {vec3(0, 3, 0), 2}};
  expect_nearest("touching", balls, 8, [](std::uint64_t i) {
    Random random(kSeed + 2, i);
    const dvec3 target = random.log_uniform(1e-6, 1) * random.direction();
    const vec3 o(random.uniform(1, 4) * random.direction()), d(target - dvec3(o));
    return Ray{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInfinity};
  });
}

TEST_F(Spheres, TheSameTwice) {
  std::vector<Ball> balls;
  for (int i = 0; i < 12; ++i) balls.push_back({vec3(static_cast<float>(i % 3), 0, 0), 0.75f});
  expect_nearest("the same four times", balls, 8, [](std::uint64_t i) {
    Random random(kSeed + 3, i);
    const vec3 o(dvec3(1, 0, 0) + random.uniform(0, 4) * random.direction());
    const vec3 d(dvec3(1, 0, 0) + 1.5 * random.uniform() * random.direction() - dvec3(o));
    return Ray{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, kInfinity};
  });
}

}  // namespace
}  // namespace kdray::stress
