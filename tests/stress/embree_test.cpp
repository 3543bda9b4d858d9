// Embree's own promises, kept without a tolerance: no ray misses a mesh of a sphere far from the origin; t, u
// and v are within 16 ulp of exact; all hits are those that a filter would collect; rays that mean nothing
// change no other's answer.
// Source: tutorials/verify of Embree 3.13 (WatertightTest, TriangleHitTest, IntersectionFilterTest, NaNTest).
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "engine/query/meshes.h"
#include "stress/exact.h"
#include "stress/lines.h"
#include "stress/table.h"
#include "support/device.h"

namespace kdray::stress {
namespace {

constexpr std::uint64_t kSeed = 13;
constexpr double kUlp = 0x1p-23;  // of 1, as a float

class EmbreePromises : public testing::Test {
 protected:
  void SetUp() override {
    if (test::usable_devices().empty()) GTEST_SKIP() << "no OpenCL device";
    set_precision();
  }
};

const dvec3 kFarCenter(148376, 1234, -223423);

std::vector<Line> make_lines(std::uint64_t seed, std::size_t n, const std::function<Line(Random&)>& make) {
  std::vector<Line> lines;
  for (std::size_t i = 0; i < n; ++i) {
    Random random(seed, i);
    lines.push_back(make(random));
  }
  return lines;
}

Rays rays_of(const std::vector<Line>& lines) {
  return {{&lines.data()->origin.x, lines.size(), sizeof(Line)},
          {&lines.data()->direction.x, lines.size(), sizeof(Line)}};
}
std::vector<Ray> floats_of(const std::vector<Line>& lines) {
  std::vector<Ray> rays;
  for (const auto& [o, d] : lines)
    rays.push_back({{static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z)},
                    0,
                    {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
                    std::numeric_limits<float>::infinity()});
  return rays;
}

// ---- Watertight

ClosedShape far_sphere(bool rounded_to_float) {
  const scene::Scene unit = test::icosphere(5);
  ClosedShape shape{"sphere", {}, {}};
  for (const dvec3& v : unit.vertices) {
    const dvec3 p = kFarCenter + 2.0 * v;
    shape.vertices.push_back(rounded_to_float ? dvec3(vec3(p)) : p);
  }
  for (const scene::Triangle& t : unit.triangles)
    shape.triangles.push_back({t.vertex[0], t.vertex[1], t.vertex[2]});
  return shape;
}

// Inside of the sphere also when it is rounded to float, and the sphere's vertices are.
dvec3 inside_far_sphere(Random& random) {
  return kFarCenter + 1.8 * std::cbrt(random.uniform()) * random.direction();
}

dvec3 surface_place(const ClosedShape& shape, Random& random) {
  switch (random.below(3)) {
    case 0:
      return some_corner(shape, random);
    case 1:
      return some_edge_point(shape, random);
    default:
      return kFarCenter + 1.9 * random.direction();
  }
}

std::uint64_t misses(const Scene& scene, const Rays& rays, std::size_t n) {
  std::vector<double> t(n);
  scene.closest(rays, {.t = t});
  std::vector<std::uint8_t> any(n);
  scene.any(rays, any);
  std::uint64_t missed = 0;
  for (std::size_t i = 0; i < n; ++i) missed += !(t[i] < HUGE_VAL) || any[i] != 1;
  return missed;
}

TEST_F(EmbreePromises, NoRayMissesAMeshOfASphereFarFromTheOrigin) {
  const std::size_t n = rays_to_trace(0.002);
  for (const bool rounded : {false, true}) {
    SCOPED_TRACE(rounded ? "vertices are floats" : "vertices are doubles");
    const ClosedShape shape = far_sphere(rounded);
    const Scene scene = committed(shape);
    const auto from_inside = [&](Random& random) {
      const dvec3 from = inside_far_sphere(random);
      return Line{from, surface_place(shape, random) - from};
    };
    // Through a vertex or an edge's point, and on to a place inside.
    const auto from_outside = [&](Random& random) {
      const dvec3 to = inside_far_sphere(random), at = surface_place(shape, random);
      const dvec3 from = at + random.log_uniform(1, 1e4) * glm::normalize(at - to);
      return Line{from, to - from};
    };
    for (const auto& make :
         {std::function<Line(Random&)>(from_inside), std::function<Line(Random&)>(from_outside)}) {
      const std::vector<Line> lines = make_lines(kSeed, n, make);
      EXPECT_EQ(misses(scene, rays_of(lines), n), 0u) << "in double, seed " << kSeed;
      const std::vector<Ray> floats = floats_of(lines);
      EXPECT_EQ(misses(scene, Rays::of(floats), n), 0u) << "in float, seed " << kSeed;
      add({"embree", "sphere far from the origin", rounded ? "float" : "double", 2 * n});
    }
  }
}

// ---- t, u and v

// The largest errors, in ulps of what they are measured against.
struct Worst {
  double t = 0, u = 0, v = 0;
  std::uint64_t n = 0, excepted = 0;
};

void take_most(double& most, double value) {
  most = std::max(most, value);
}

// Embree's test as it is: a right angle's triangle, rays straight at it; errors in ulps of 1.
TEST_F(EmbreePromises, TheRightTriangleIsExactToSixteenUlps) {
  const std::vector<float> vertices{0, 0, 0, 1, 0, 0, 0, 1, 0};
  Scene scene;
  scene.add_mesh({vertices, std::vector<std::uint32_t>{0, 1, 2}});
  scene.commit();
  const std::size_t n = rays_to_trace(0.001);
  const std::vector<Line> lines = make_lines(kSeed + 1, n, [](Random& random) {
    double u = random.below(2) ? random.uniform() : random.log_uniform(1e-30, 1);
    double v = random.below(2) ? random.uniform() : random.log_uniform(1e-30, 1);
    if (u + v > 0.999) u = 0.999 * (1 - u), v = 0.999 * (1 - v);
    u = std::abs(u), v = std::abs(v);
    if (u + v > 0.999) u /= 2, v /= 2;
    return Line{dvec3(vec3(u, v, -1)), dvec3(0, 0, 1)};
  });
  const std::vector<Ray> rays = floats_of(lines);
  std::vector<double> t(n), u(n), v(n);
  scene.closest(Rays::of(rays), {.t = t, .u = u, .v = v});
  Worst worst, relative;
  for (std::size_t i = 0; i < n; ++i) {
    const dvec3& o = lines[i].origin;
    ASSERT_LT(t[i], HUGE_VAL) << in_words(lines[i]) << ", seed " << kSeed + 1;
    take_most(worst.t, std::abs(t[i] - 1) / kUlp);
    take_most(worst.u, std::abs(u[i] - o.x) / kUlp);
    take_most(worst.v, std::abs(v[i] - o.y) / kUlp);
    take_most(relative.u, std::abs(u[i] - o.x) / (kUlp * o.x));
    take_most(relative.v, std::abs(v[i] - o.y) / (kUlp * o.y));
  }
  EXPECT_LE(worst.t, 16);
  EXPECT_LE(worst.u, 16);
  EXPECT_LE(worst.v, 16);
  std::printf("right triangle, %zu rays: t %.3g, u %.3g, v %.3g ulps of 1; u %.3g, v %.3g of themselves\n", n,
              worst.t, worst.u, worst.v, relative.u, relative.v);
}

// Triangles of any shape: 2000 of sizes of 1 to 1/1000 in a cube.
ClosedShape scattered() {
  ClosedShape shape{"scattered", {}, {}};
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Random random(kSeed + 2, i);
    const dvec3 at(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const double size = random.log_uniform(1e-3, 1);
    for (int k = 0; k < 3; ++k)
      shape.vertices.push_back(dvec3(vec3(at + size * random.uniform() * random.direction())));
    shape.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  shape.lo = dvec3(-2), shape.hi = dvec3(2);
  return shape;
}

Exact3 exactly(const dvec3& v) {
  return {Exact(v.x), Exact(v.y), Exact(v.z)};
}
Exact3 less(const Exact3& a, const Exact3& b) {
  return {Exact(a.x - b.x), Exact(a.y - b.y), Exact(a.z - b.z)};
}
Exact3 product(const Exact3& a, const Exact3& b) {
  return {Exact(a.y * b.z - a.z * b.y), Exact(a.z * b.x - a.x * b.z), Exact(a.x * b.y - a.y * b.x)};
}
Exact scalar(const Exact3& a, const Exact3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct ExactHit {
  double t, u, v;
};

// Cramer's rule tells it.
ExactHit exact_hit(const Line& line, const dvec3& a, const dvec3& b, const dvec3& c, const ExactHit& from) {
  const Exact3 e = less(exactly(b), exactly(a)), f = less(exactly(c), exactly(a)),
               d = exactly(line.direction);
  const Exact3 o = less(exactly(line.origin), exactly(a)), p = product(d, f);
  const Exact det = scalar(p, e);
  const Exact3 q = product(o, e);
  return {Exact(from.t - scalar(q, f) / det).get_d(), Exact(from.u - scalar(p, o) / det).get_d(),
          Exact(from.v - scalar(q, d) / det).get_d()};
}

// As the ray sees it, the height of corner p above the side from q to r.
double height_seen(const dvec3& d, const dvec3& p, const dvec3& q, const dvec3& r) {
  const auto seen = [&](const dvec3& v) { return v - glm::dot(v, d) / glm::dot(d, d) * d; };
  const dvec3 side = seen(r - q), up = seen(p - q);
  const double length = glm::length(side);
  return length > 0 ? glm::length(glm::cross(side, up)) / length : 0;
}

// A corner's place as the ray sees it is rounded, by 5u of its distance, and with it what is measured from
// it: u and v by that over the triangle's height, t by that over the cosine at which the ray meets the plane.
// So ulps are those of the farthest corner's distance, over these; u and v of 0 cannot have ulps of their
// own.
void take(const ClosedShape& shape, const Line& line, double reach, std::uint32_t primitive,
          const ExactHit& hit, Worst& worst) {
  const dvec3 &a = shape.corner(primitive, 0), &b = shape.corner(primitive, 1),
              &c = shape.corner(primitive, 2);
  const dvec3& d = line.direction;
  const double of_u = height_seen(d, b, a, c), of_v = height_seen(d, c, a, b);
  const dvec3 n = glm::cross(b - a, c - a);
  const double cosine = std::abs(glm::dot(n, d)) / (glm::length(n) * glm::length(d));
  // Where a height is no more than what it is rounded by nothing can be said of u and v.
  if (std::min(of_u, of_v) < 0x1p-12 * reach || cosine < 0x1p-8) {
    ++worst.excepted;
    return;
  }
  const ExactHit off = exact_hit(line, a, b, c, hit);
  ++worst.n;
  take_most(worst.t, std::abs(off.t) * glm::length(d) * cosine / (kUlp * reach));
  take_most(worst.u, std::abs(off.u) * of_u / (kUlp * reach));
  take_most(worst.v, std::abs(off.v) * of_v / (kUlp * reach));
}

void expect_sixteen_ulps(const Scene& scene, const ClosedShape& shape, const Rays& rays,
                         const std::vector<Line>& lines, bool far, const char* name) {
  const std::size_t n = lines.size();
  std::vector<double> t(n), u(n), v(n);
  std::vector<std::uint32_t> primitive(n);
  scene.closest(rays, {.t = t, .primitive = primitive, .u = u, .v = v});
  Worst worst;
  for (std::size_t i = 0; i < n; ++i) {
    if (primitive[i] == kNoPrimitive) continue;
    // Rays in double are begun anew where they enter the bounds.
    const double reach = far ? 4 * std::sqrt(3.0) : glm::length(lines[i].origin) + 2 * std::sqrt(3.0);
    take(shape, lines[i], reach, primitive[i], {t[i], u[i], v[i]}, worst);
  }
  EXPECT_LE(worst.t, 16) << name << ", seed " << kSeed + 3;
  EXPECT_LE(worst.u, 16) << name;
  EXPECT_LE(worst.v, 16) << name;
  EXPECT_GT(worst.n, n / 10) << name;
  add({"embree", name, "t, u, v", worst.n, 0, worst.excepted});
  std::printf("%s, %llu hits: t %.3g, u %.3g, v %.3g of the ulps that are promised\n", name,
              static_cast<unsigned long long>(worst.n), worst.t, worst.u, worst.v);
}

TEST_F(EmbreePromises, AnyTriangleIsExactToSixteenUlps) {
  const ClosedShape shape = scattered();
  const Scene scene = committed(shape);
  const std::size_t n = rays_to_trace(0.0005);
  const auto at_some = [&](Random& random, double away) {
    const std::size_t i = random.below(shape.triangles.size());
    const dvec3 w = random.weights();
    const dvec3 at = w.x * shape.corner(i, 0) + w.y * shape.corner(i, 1) + w.z * shape.corner(i, 2);
    const dvec3 from = at + away * random.direction();
    return Line{from, random.log_uniform(0.1, 10) * (at - from)};
  };
  const std::vector<Line> near = make_lines(kSeed + 3, n, [&](Random& random) {
    const Line line = at_some(random, random.log_uniform(0.1, 10));
    return Line{dvec3(vec3(line.origin)), dvec3(vec3(line.direction))};
  });
  const std::vector<Ray> floats = floats_of(near);
  expect_sixteen_ulps(scene, shape, Rays::of(floats), near, false, "rays in float");
  // t of a double is as exact from afar; its direction has to be, too, to meet the same place.
  const std::vector<Line> far =
      make_lines(kSeed + 4, n, [&](Random& random) { return at_some(random, random.log_uniform(10, 1e4)); });
  expect_sixteen_ulps(scene, shape, rays_of(far), far, true, "rays in double from afar");
}

// ---- All hits

// What a filter that refuses each hit would be called with: closest hits, each from behind the last.
std::vector<std::vector<double>> one_by_one(const Scene& scene, std::vector<Ray> rays) {
  std::vector<std::vector<double>> found(rays.size());
  for (bool more = true; more;) {
    more = false;
    std::vector<double> t(rays.size());
    scene.closest(Rays::of(rays), {.t = t});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!(t[i] < HUGE_VAL)) {
        rays[i].t_max = -1;
        continue;
      }
      found[i].push_back(t[i]);
      rays[i].t_min = static_cast<float>(t[i]);
      more = true;
    }
  }
  return found;
}

TEST_F(EmbreePromises, AllHitsAreThoseThatAFilterWouldCollect) {
  const auto spheres = [](double radius, int n) {
    Scene scene;
    std::vector<double> centers, radii;
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < 3; ++k) centers.push_back(kFarCenter[k]);
      radii.push_back(radius * (i + 1) / n);
    }
    scene.add_spheres({centers, radii});
    return scene;
  };
  const auto mesh = [] {
    const ClosedShape shape = far_sphere(false);
    Scene scene;
    scene.add_mesh({points_of(shape.vertices), shape.triangles});
    return scene;
  };
  const std::size_t n = rays_to_trace(0.0002);
  const std::vector<Ray> rays = floats_of(make_lines(kSeed + 5, n, [](Random& random) {
    const dvec3 from = kFarCenter + random.log_uniform(3, 100) * random.direction();
    return Line{from, kFarCenter + 1.9 * random.uniform() * random.direction() - from};
  }));
  for (const int n_spheres : {0, 1, 40}) {
    SCOPED_TRACE(n_spheres);
    Scene scene = n_spheres == 0 ? mesh() : spheres(2, n_spheres);
    scene.commit();
    const AllHits all = scene.all(Rays::of(rays));
    const std::vector<std::vector<double>> filtered = one_by_one(scene, rays);
    std::size_t differing = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<double> t(all.t.begin() + static_cast<long>(all.splits[i]),
                                  all.t.begin() + static_cast<long>(all.splits[i + 1]));
      if (n_spheres < 2) {
        ASSERT_EQ(t.size(), 2u) << "seed " << kSeed + 5 << ", ray " << i;
      }
      if (t != filtered[i] && differing++ < 3) ADD_FAILURE() << "ray " << i << ", seed " << kSeed + 5;
    }
    EXPECT_EQ(differing, 0u);
    add({"embree", "all hits, as by a filter", std::to_string(n_spheres), n, differing});
  }
}

// ---- Rays that mean nothing

double seconds_of(const std::function<void()>& call) {
  double least = HUGE_VAL;
  for (int i = 0; i < 5; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

// The times are printed for the logbook; nothing is expected of them here.
TEST_F(EmbreePromises, RaysThatMeanNothingChangeNoOthersAnswer) {
  const ClosedShape shape = far_sphere(false);
  const Scene scene = committed(shape);
  const std::size_t n = is_full() ? 1'000'000 : 100'000;
  const std::vector<Ray> rays = floats_of(make_lines(kSeed + 6, n, [](Random& random) {
    const dvec3 from = kFarCenter + 5.0 * random.direction();
    return Line{from, kFarCenter + 2.5 * random.direction() - from};
  }));
  std::vector<double> expected(n), t(n);
  const QueryOptions as_misses{.invalid = InvalidRays::miss};
  const double usual = seconds_of([&] { scene.closest(Rays::of(rays), {.t = expected}, as_misses); });
  for (const std::size_t every : {1000, 2, 1}) {
    std::vector<Ray> some = rays;
    std::uint64_t n_bad = 0;
    for (std::size_t i = 0; i < n; i += every, ++n_bad) {
      const float bad =
          i / every % 2 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
      (i / every % 4 < 2 ? some[i].origin : some[i].direction)[i / every % 3] = bad;
    }
    QueryReport report;
    const double seconds = seconds_of([&] { report = scene.closest(Rays::of(some), {.t = t}, as_misses); });
    EXPECT_EQ(report.invalid, n_bad);
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_EQ(t[i], i % every == 0 ? HUGE_VAL : expected[i]) << "seed " << kSeed + 6 << ", ray " << i;
    std::printf("one ray of %zu means nothing: %.2f times as long (%.1f million a second without)\n", every,
                seconds / usual, static_cast<double>(n) / usual / 1e6);
  }
}

}  // namespace
}  // namespace kdray::stress
