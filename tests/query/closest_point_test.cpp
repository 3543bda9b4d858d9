// Closest points against exact arithmetic: distances to a share of 2^-40 (a float's last place is 2^-24), the primitive that
// is closest, of equally close ones the smallest number, and a point that lies there.
#include "query/closest_point.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <random>

#include "primitives/shapes.h"
#include "query/asked.h"
#include "query/exact_distance.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

constexpr std::uint64_t kSeed = 20261124;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine_); }
  dvec3 in_cube(double half) {
    const double x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  dvec3 direction() {
    for (;;)
      if (const dvec3 d = in_cube(1); glm::dot(d, d) > 0.01 && glm::dot(d, d) <= 1) return glm::normalize(d);
  }

 private:
  std::mt19937_64 engine_;
};

// ---- Scenes.

void add_triangle(scene::Scene& s, const dvec3& a, const dvec3& b, const dvec3& c) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  for (const dvec3& v : {a, b, c}) s.vertices.push_back(v);
  scene::Triangle t{.vertex = {first, first + 1, first + 2}};
  t.number = s.primitive_count();
  s.triangles.push_back(t);
}

scene::Scene empty_scene() {
  scene::Scene s;
  s.materials.emplace_back();
  return s;
}

// Triangles of sizes that differ by factors of up to 10^`decades`.
scene::Scene soup(int n, double decades) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 middle = random.in_cube(1);
    const double size = 0.3 * std::pow(10.0, random.between(-decades, 0));
    add_triangle(s, middle + size * random.direction(), middle + size * random.direction(),
                 middle + size * random.direction());
  }
  return s;
}

// Long ones, a 10^-2 to 10^-7 of their length across.
scene::Scene slivers(int n) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 from = random.in_cube(1), way = random.direction();
    const double width = std::pow(10.0, random.between(-7, -2));
    add_triangle(s, from, from + way, from + random.between(0, 1) * way + width * random.direction());
  }
  return s;
}

// A height field over whole numbers, whose corners and edges its triangles share.
scene::Scene grid(int n) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      s.vertices.push_back({double(x), double(y), x < n / 2 ? 0.0 : double(random.below(3))});
  const auto at = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const std::array<std::uint32_t, 3>& corners :
           {std::array{at(x, y), at(x + 1, y), at(x + 1, y + 1)},
            {at(x, y), at(x + 1, y + 1), at(x, y + 1)}}) {
        scene::Triangle t{.vertex = corners};
        t.number = s.primitive_count();
        s.triangles.push_back(t);
      }
  return s;
}

// All of it is equally far from the middle.
scene::Scene ball(int n) {
  scene::Scene s = empty_scene();
  const auto at = [n](int i, int j) {
    const double a = std::numbers::pi * i / n, b = std::numbers::pi * j / n;
    return dvec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) add_triangle(s, at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + 1 < n) add_triangle(s, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return s;
}

scene::Scene spheres(int n) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i)
    s.spheres.push_back(
        {random.in_cube(1), std::pow(10.0, random.between(-3, -0.5)), 0, s.primitive_count()});
  return s;
}

scene::Scene cones(int n) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i) {
    const dvec3 base = random.in_cube(1);
    const double size = std::pow(10.0, random.between(-2, 0)),
                 radius = size * std::pow(10.0, random.between(-2, 0.5));
    const double apex_radius =
        random.below(3) == 0 ? 0 : (random.below(3) == 0 ? radius : random.between(0, radius));
    s.cones.push_back({base, base + size * random.direction(), radius, apex_radius, 0, s.primitive_count()});
  }
  return s;
}

scene::Scene discs(int n) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i)
    s.discs.push_back({random.in_cube(1), random.direction(), std::pow(10.0, random.between(-2.5, -0.3)), 0,
                       s.primitive_count()});
  return s;
}

scene::Scene all_kinds() {
  scene::Scene s = soup(60, 1);
  const auto take = [&s](const auto& from, auto& to) {
    for (auto shape : from) {
      shape.number = s.primitive_count();
      to.push_back(shape);
    }
  };
  take(spheres(40).spheres, s.spheres);
  take(cones(40).cones, s.cones);
  take(discs(40).discs, s.discs);
  return s;
}

scene::Scene moved(scene::Scene s, double scale, const dvec3& by) {
  for (dvec3& v : s.vertices) v = scale * v + by;
  return s;
}

// ---- Points, in the world.

// Places on primitives: corners, on edges and inside; of shapes, of their outline boxes' middles.
std::vector<dvec3> places_on(const Asked& asked, std::size_t n, Random& random) {
  const auto& triangles = asked.prepared().flat.triangles;
  std::vector<dvec3> places;
  while (places.size() < n && triangles.size() > 0) {
    const layout::Triangle& t = triangles[random.below(triangles.size())];
    const auto corner = [&](std::size_t i) { return dvec3(t.v[i][0], t.v[i][1], t.v[i][2]); };
    double u = random.between(0, 1), v = random.between(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const std::size_t choice = random.below(4);
    if (choice == 0) u = v = 0;
    if (choice == 1) v = 0;
    if (choice == 2) u = 0.5, v = 0.5;
    places.push_back(corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0)));
  }
  return places;
}

std::vector<dvec3> points_for(const Asked& asked, std::size_t n) {
  Random random(kSeed + 1);
  const LocalSpace& space = asked.space();
  const Box& bounds = asked.prepared().geometry.bounds;
  const dvec3 middle(bounds.center());
  const double half = 0.5 * largest_component(dvec3(bounds.extent()));
  std::vector<dvec3> points;
  const auto add = [&](const dvec3& local) { points.push_back(space.world(local)); };
  for (std::size_t i = 0; i < n / 5; ++i) add(middle + random.in_cube(1.3 * half));
  for (std::size_t i = 0; i < n / 20; ++i)
    add(middle + half * std::pow(10.0, random.between(0, 4)) * random.direction());
  for (std::size_t i = 0; i < n / 20; ++i)
    add(middle + half * std::pow(10.0, random.between(4, 11)) * random.direction());
  for (const dvec3& p : places_on(asked, n / 10, random)) add(p);
  for (const dvec3& p : places_on(asked, n / 3, random))
    add(p + half * std::pow(10.0, random.between(-16, -1)) * random.direction());
  // Whole numbers and halves of the world, which lie above edges and corners of grids.
  for (std::size_t i = 0; i < n / 20; ++i) {
    const dvec3 p = space.world(middle + random.in_cube(1.3 * half));
    points.push_back(dvec3(0.5 * std::round(2 * p.x), 0.5 * std::round(2 * p.y), 0.5 * std::round(2 * p.z)));
  }
  while (points.size() < n) add(middle + random.in_cube(0.5 * half));
  return points;
}

// ---- What is exact.

struct Candidate {
  std::uint32_t number;
  Exact exact;
};

template <class Visit>
void for_each_primitive(const Asked& asked, const Visit& visit) {
  primitives::for_each_kind([&](auto kind) {
    for (const auto& primitive : decltype(kind)::of(asked.prepared().flat)) visit(primitive);
  });
}

// The primitives that may be closest, by their exact distances; the closest first, of equal ones the smallest number.
std::vector<Candidate> candidates(const Asked& asked, const dvec3& local, double allowed) {
  std::vector<std::pair<long double, std::uint32_t>> rough;
  for_each_primitive(asked, [&](const auto& p) { rough.emplace_back(rough_distance(local, p), p.number); });
  const long double least = std::min_element(rough.begin(), rough.end())->first;
  const long double margin = 0x1p-48L * (largest_component(local) + 0x1p11L) + 2 * allowed;
  std::vector<Candidate> found;
  std::size_t i = 0;
  for_each_primitive(asked, [&](const auto& p) {
    if (rough[i++].first <= least + margin) found.push_back({p.number, exact_distance(local, p)});
  });
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.exact != b.exact ? a.exact < b.exact : a.number < b.number;
  });
  return found;
}

// Errors of distances, in units of a double's last place: how many are within each power of 4.
struct Errors {
  std::array<std::size_t, 16> within{};  // [k]: at most 4^k / 2
  double most_float_ulps = 0, most = 0;  // most: of the distance, as a share of it
  std::size_t n = 0, ties = 0;

  void add(double share, double float_ulps) {
    std::size_t k = 0;
    while (k + 1 < within.size() && share > std::ldexp(0.5, -52 + 2 * static_cast<int>(k))) ++k;
    ++within[k];
    ++n;
    most_float_ulps = std::max(most_float_ulps, float_ulps);
    most = std::max(most, share);
  }
  void print(const std::string& name) const {
    std::string line = fmt::format("{:<22} {:>6} points, {:>5} ties; at most {:.2g} ulp of float, 2^{:.1f}; ",
                                   name, n, ties, most_float_ulps, std::log2(most));
    for (std::size_t k = 0; k < within.size(); ++k)
      if (within[k] > 0) line += fmt::format(" {}:{}", 0.5 * std::pow(4.0, k), within[k]);
    fmt::print("{}\n", line);
  }
};

struct Promise {
  double share, of_scene;  // of the distance, and of the scene's size
  double place;            // of the closest point, of the scene's size
};
constexpr Promise kInDoubles{0x1p-40, 0x1p-98, 0x1p-48}, kInPairsOfFloats{0x1p-36, 0x1p-28, 0x1p-19};

double float_ulp(double x) {
  return std::ldexp(1.0, std::max(std::ilogb(x), -126) - 23);
}

class Judge {
 public:
  Judge(const Asked& asked, const Promise& promise) : asked_(asked), promise_(promise) {}

  void judge(std::size_t i, const dvec3& point, const query::ClosestPoint& answer) {
    const LocalSpace& space = asked_.space();
    const dvec3 local = space.local(point);
    const double allowed_of_scene = promise_.of_scene * 0x1p11;
    const std::vector<Candidate> all = candidates(asked_, local, allowed_of_scene);
    const Exact& least = all.front().exact;
    const Exact off = abs(Exact(space.local_length(answer.distance)) - least);
    const Exact allowed = promise_.share * least + allowed_of_scene;
    const double distance = least.get_d();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Candidate& c) {
      return c.number == static_cast<std::uint32_t>(answer.primitive);
    });
    const std::lock_guard lock(mutex_);
    const auto where = [&] {
      return fmt::format("point {} ({}, {}, {}), seed {}: {} of {}, exactly {:.17g} of {}", i, point.x,
                         point.y, point.z, kSeed, answer.distance, answer.primitive,
                         space.world_length(distance), all.front().number);
    };
    EXPECT_LE(off, allowed) << where();
    if (distance > 0x1p20 * allowed_of_scene)
      errors.add(Exact(off / least).get_d(), Exact(off / float_ulp(distance)).get_d());
    ASSERT_NE(found, all.end()) << where();
    EXPECT_LE(found->exact - least, allowed) << where();
    // Of equal ones the smallest number, unless one that is smaller still rounds to the same.
    if (promise_.share == kInDoubles.share && found->exact - least <= 0x1p-52 * least) {
      EXPECT_LE(answer.primitive, static_cast<std::int32_t>(all.front().number)) << where() << ", a tie";
    }
    if (all.size() > 1 && all[1].exact == least) ++errors.ties;
    expect_place(where(), local, distance, answer);
  }

  Errors errors;

 private:
  // The point is on the primitive, and as far away as it is said to be.
  void expect_place(const std::string& where, const dvec3& local, double distance,
                    const query::ClosestPoint& answer) const {
    const LocalSpace& space = asked_.space();
    const dvec3 place = space.local(answer.point);
    const double size = largest_component(local) + 0x1p11 + largest_component(space.center) * space.scale;
    double tolerance = promise_.place * size;
    if (largest_component(local) > 0x1p36) tolerance = 0x1p-50 * size + 0x1p-4;
    EXPECT_NEAR(static_cast<double>(glm::length(local - place)), distance, tolerance) << where;
    double away = kInfinity;
    for_each_primitive(asked_, [&](const auto& p) {
      if (static_cast<std::int32_t>(p.number) == answer.primitive)
        away = static_cast<double>(rough_distance(place, p));
    });
    EXPECT_LE(away, tolerance) << where;
  }

  const Asked& asked_;
  const Promise promise_;
  std::mutex mutex_;
};

void expect_exact(const std::string& name, const scene::Scene& scene, const std::string& device,
                  std::size_t n, const std::string& build_options = "", const Promise& promise = kInDoubles) {
  set_exact_precision();
  Asked asked(scene, device, build_options);
  const std::vector<dvec3> points = points_for(asked, n);
  const query::ClosestPoints answers = query::closest_points(asked.target(), points, kInfinity);
  ASSERT_EQ(answers.points.size(), points.size());
  Judge judge(asked, promise);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (!testing::Test::HasFailure()) judge.judge(i, points[i], answers.points[i]);
  });
  judge.errors.print(name);
}

class ClosestPoints : public EachDevice {
 protected:
  static constexpr std::size_t kPoints = 10000;
};

TEST_P(ClosestPoints, OfTrianglesAreExact) {
  expect_exact("triangles", soup(300, 1), GetParam(), kPoints);
  expect_exact("of all sizes", soup(300, 7), GetParam(), kPoints);
  expect_exact("slivers", slivers(300), GetParam(), kPoints);
  expect_exact("one", soup(1, 0), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfSharedCornersAndEdgesAreTheSmallestNumber) {
  expect_exact("grid", grid(12), GetParam(), kPoints);
  expect_exact("grid far off", moved(grid(12), 0.25, {4096, -8192, 2048}), GetParam(), kPoints);
  expect_exact("ball", ball(12), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfScenesOfAnySizeAndPlaceAreExact) {
  expect_exact("tiny", moved(soup(200, 2), 1e-30, dvec3(0)), GetParam(), kPoints);
  expect_exact("huge", moved(soup(200, 2), 1e30, dvec3(0)), GetParam(), kPoints);
  expect_exact("far off", moved(soup(200, 2), 1, {1e6, -3e6, 2e5}), GetParam(), kPoints);
}

TEST_P(ClosestPoints, OfShapesAreExact) {
  expect_exact("spheres", spheres(200), GetParam(), kPoints);
  expect_exact("cones", cones(200), GetParam(), kPoints);
  expect_exact("discs", discs(200), GetParam(), kPoints);
  expect_exact("all kinds", all_kinds(), GetParam(), kPoints);
}

// What devices without doubles do.
TEST_P(ClosestPoints, InPairsOfFloatsAreRightToAFloatsLastPlaces) {
  const std::string floats = "-DKDRAY_PRECISE=32";
  expect_exact("triangles in floats", soup(300, 1), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
  expect_exact("grid in floats", grid(12), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
  expect_exact("all kinds in floats", all_kinds(), GetParam(), kPoints / 4, floats, kInPairsOfFloats);
}

KDRAY_FOR_EACH_DEVICE(ClosestPoints);

}  // namespace
}  // namespace kdray::test
