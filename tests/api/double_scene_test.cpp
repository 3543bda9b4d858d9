// Scenes of doubles (TreeOptions::geometry): every answer against GMP's rationals, over the vertices and rays
// as they were given: which triangle is hit, by the half-open rule, how often, and where.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "api/double_scenes.h"
#include "kdray/kdray.h"

namespace kdray {
namespace {

using namespace test::doubles;
using test::Exact;
using test::exact;
using test::minus;
using test::Point;
using test::volume;

constexpr unsigned kSeed = 440;

class DoubleScenes : public OnEachDevice {
 protected:
  // Packets of one ray's copies, and of others.
  static RayList copies_of(const RayList& list, std::size_t copies, bool in_row,
                           std::vector<std::size_t>& of) {
    RayList many;
    of.resize(list.origins.size() * copies);
    for (std::size_t i = 0; i < of.size(); ++i) {
      of[i] = in_row ? i / copies : i % list.origins.size();
      many.origins.push_back(list.origins[of[i]]);
      many.directions.push_back(list.directions[of[i]]);
      if (!list.t_max.empty()) {
        many.t_min.push_back(list.t_min[of[i]]);
        many.t_max.push_back(list.t_max[of[i]]);
      }
    }
    return many;
  }

  void many_agree(const Scene& scene, const RayList& list, const std::vector<double>& t,
                  const std::vector<std::uint32_t>& primitive, const std::vector<double>& u,
                  const std::vector<double>& v, const std::vector<std::uint8_t>& any) const {
    for (const bool in_row : {false, true}) {
      SCOPED_TRACE(in_row);
      std::vector<std::size_t> of;
      const RayList many = copies_of(list, kMany / list.origins.size() + 1, in_row, of);
      std::vector<double> of_t(of.size()), of_u(of.size()), of_v(of.size());
      std::vector<std::uint32_t> of_primitive(of.size());
      std::vector<std::uint8_t> of_any(of.size());
      scene.closest(many.rays(), {.t = of_t, .primitive = of_primitive, .u = of_u, .v = of_v});
      scene.any(many.rays(), of_any);
      for (std::size_t i = 0; i < of.size(); ++i) {
        ASSERT_EQ(of_primitive[i], primitive[of[i]]) << of[i];
        ASSERT_EQ(of_t[i], t[of[i]]) << of[i];
        ASSERT_EQ(of_u[i], u[of[i]]) << of[i];
        ASSERT_EQ(of_v[i], v[of[i]]) << of[i];
        ASSERT_EQ(of_any[i], any[of[i]]) << of[i];
      }
    }
  }

  void many_count(const Scene& scene, const RayList& list, const std::vector<std::uint32_t>& counts,
                  const AllHits& all) const {
    for (const bool in_row : {false, true}) {
      SCOPED_TRACE(in_row);
      std::vector<std::size_t> of;
      const RayList many = copies_of(list, kMany / list.origins.size() + 1, in_row, of);
      std::vector<std::uint32_t> of_counts(of.size());
      scene.count(many.rays(), of_counts);
      AllHitsOptions two;
      two.max_hits = 2;
      const AllHits of_all = scene.all(many.rays()), first = scene.all(many.rays(), two);
      for (std::size_t i = 0; i < of.size(); ++i) {
        const std::uint64_t begin = all.splits[of[i]], n = all.splits[of[i] + 1] - begin;
        ASSERT_EQ(of_counts[i], counts[of[i]]) << of[i];
        ASSERT_EQ(of_all.splits[i + 1] - of_all.splits[i], n) << of[i];
        ASSERT_EQ(first.splits[i + 1] - first.splits[i], std::min<std::uint64_t>(n, 2)) << of[i];
        ASSERT_EQ(first.more[i], n > 2) << of[i];
        for (std::uint64_t k = 0; k < n; ++k) {
          ASSERT_EQ(of_all.primitive[of_all.splits[i] + k], all.primitive[begin + k]) << of[i];
          ASSERT_EQ(of_all.t[of_all.splits[i] + k], all.t[begin + k]) << of[i];
          if (k >= 2) continue;
          ASSERT_EQ(first.primitive[first.splits[i] + k], all.primitive[begin + k]) << of[i];
        }
      }
    }
  }

  void holds(const DoubleMesh& mesh, const RayList& list) const {
    const Scene scene = scene_of(mesh);
    const std::size_t n = list.origins.size();
    std::vector<double> t(n), u(n), v(n);
    std::vector<std::uint32_t> primitive(n), counts(n);
    std::vector<std::uint8_t> any(n);
    scene.closest(list.rays(), {.t = t, .primitive = primitive, .u = u, .v = v});
    scene.any(list.rays(), any);
    scene.count(list.rays(), counts);
    const AllHits all = scene.all(list.rays());
    many_agree(scene, list, t, primitive, u, v, any);
    many_count(scene, list, counts, all);
    for (std::size_t i = 0; i < n; ++i) {
      SCOPED_TRACE(i);
      std::vector<Crossing> found = Line(list.origins[i], list.directions[i]).crossings(mesh);
      const double t_min = list.t_min.empty() ? 0 : list.t_min[i];
      const double t_max = list.t_max.empty() ? kInfinity : list.t_max[i];
      std::erase_if(found, [&](const Crossing& c) {
        if (c.t < t_min || (t_min != 0 && c.t == t_min)) return true;
        return std::isinf(t_max) ? t_max < 0 : c.t >= t_max;
      });
      ASSERT_EQ(counts[i], found.size());
      ASSERT_EQ(all.splits[i + 1] - all.splits[i], found.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_EQ(all.primitive[all.splits[i] + k], found[k].triangle);
        ASSERT_LT(places_off(all.t[all.splits[i] + k], found[k].t), 2);
      }
      std::erase_if(found, [&](const Crossing& c) { return c.t == t_min; });
      ASSERT_EQ(any[i], !found.empty());
      if (found.empty()) {
        ASSERT_EQ(t[i], kInfinity);
        ASSERT_EQ(primitive[i], kNoPrimitive);
        continue;
      }
      ASSERT_EQ(primitive[i], found.front().triangle);
      ASSERT_LT(places_off(t[i], found.front().t), 2);
      ASSERT_NEAR(u[i], found.front().u, 1e-15);
      ASSERT_NEAR(v[i], found.front().v, 1e-15);
    }
  }
};
KDRAY_FOR_EACH_DEVICE(DoubleScenes);

TEST_P(DoubleScenes, HitsAreThoseOfRationals) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  // What floats about the scene's centre can't hold: tiny detail far off, and beside what is large.
  DoubleMesh apart = ring(9, 7, {1e6, -2e6, 3e6}, 1e-4, random);
  holds(apart, aimed(apart, 600, 1e-4, random));
  DoubleMesh beside = ring(9, 7, {0.1, 0.2, 0.3}, 1e-9, random);
  const RayList at_detail = aimed(beside, 300, 1e-9, random);
  add(beside, ring(5, 5, {3, 4, 5}, 1e3, random));
  holds(beside, at_detail);
  holds(beside, aimed(beside, 600, 1e3, random));
  const DoubleMesh near = sheets();
  holds(near, aimed(near, 600, 1, random));
}

TEST_P(DoubleScenes, OfAnySizeHitsAreThoseOfRationals) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 8);
  for (const double size : {1e-290, 1e-30, 1e30, 1e290}) {
    SCOPED_TRACE(size);
    const DoubleMesh mesh = ring(9, 7, {size, -size, 2 * size}, size, random);
    holds(mesh, aimed(mesh, 200, size, random));
  }
}

TEST_P(DoubleScenes, ExtentIsThatOfTheDoubles) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 9);
  for (const double size : {1e-290, 1e-30, 1.0, 1e290}) {
    SCOPED_TRACE(size);
    const DoubleMesh mesh = ring(9, 7, {size, -size / 3, 2e6 * size}, size, random);
    const std::optional<Extent> extent = scene_of(mesh).extent();
    ASSERT_TRUE(extent);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [least, greatest] =
          std::ranges::minmax(mesh.vertices, {}, [k](const Point& vertex) { return vertex[k]; });
      EXPECT_EQ(extent->least[k], least[k]);
      EXPECT_EQ(extent->greatest[k], greatest[k]);
    }
  }
}

TEST_P(DoubleScenes, WhatFloatsAreNearlySureOfIsAsInRationals) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 6);
  const DoubleMesh coarse = ring(9, 7, {0.1, 0.2, 0.3}, 1, random);
  holds(coarse, beside(coarse, 3000, 1, random));
  // Triangles as small as floats are off by, far from the centre: a needle makes the scene large.
  DoubleMesh fine = ring(9, 7, {0.7, -0.2, 0.5}, 3e-5, random);
  fine.vertices.insert(fine.vertices.end(), {{-1, -1, -1}, {1, 1, 1}, {1, 1, 1 + 1e-7}});
  const auto first = static_cast<std::uint32_t>(fine.vertices.size() - 3);
  for (std::uint32_t k = 0; k < 3; ++k) fine.triangles.push_back(first + k);
  holds(fine, beside(fine, 1500, 3e-5, random));
  holds(fine, beside(fine, 1500, 1, random));
}

// Nearly in the plane of the face that they are aimed at.
TEST_P(DoubleScenes, GrazingRaysHitWhatRationalsSay) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 6);
  std::uniform_real_distribution<double> share(-1, 1);
  const DoubleMesh mesh = ring(9, 7, {0.5, 0.25, -0.5}, 1, random);
  RayList list;
  for (int i = 0; i < 8000; ++i) {
    const std::size_t face = random() % mesh.size();
    const Point a = mesh.corner(face, 0), b = mesh.corner(face, 1), c = mesh.corner(face, 2);
    const double along = share(random), across = share(random), tilt = std::ldexp(share(random), -i % 54);
    Point origin, direction;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
      const double normal = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
      direction[k] = along * (b[k] - a[k]) + across * (c[k] - a[k]) + tilt * normal;
      origin[k] = (a[k] + b[k] + c[k]) / 3 - 5 * direction[k];
    }
    list.origins.push_back(origin);
    list.directions.push_back(direction);
  }
  holds(mesh, list);
}

// Of two that lie one behind the other, by about as much as floats are off, seen face on to nearly edge-on,
// far from the scene's centre.
TEST_P(DoubleScenes, OfTwoSlantingFacesTheNearerIsHit) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 10);
  std::uniform_real_distribution<double> share(-1, 1);
  DoubleMesh mesh{{{-64, -64, -64}, {64, 64, 64}, {64, 64, 63}}, {0, 1, 2}};
  RayList list;
  for (int pair = 0; pair < 80; ++pair) {
    Point at, direction, across, along, corners[3];
    for (Point* p : {&at, &direction, &across, &along})
      for (double& c : *p) c = share(random);
    for (double& c : at) c += 50;
    const double steep = std::ldexp(1, pair % 7), apart = std::ldexp(1, -12 - pair % 11);
    for (std::size_t k = 0; k < 3; ++k) {
      corners[0][k] = at[k];
      corners[1][k] = at[k] + 0.1 * (across[k] + steep * direction[k]);
      corners[2][k] = at[k] + 0.1 * (along[k] - steep * direction[k]);
    }
    for (const double behind : {pair % 2 ? apart : 0.0, pair % 2 ? 0.0 : apart})
      for (const Point& corner : corners) {
        mesh.triangles.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        Point& moved = mesh.vertices.emplace_back(corner);
        for (std::size_t k = 0; k < 3; ++k) moved[k] += behind * direction[k];
      }
    for (int i = 0; i < 40; ++i) {
      const double u = std::abs(share(random)), v = std::abs(share(random)) * (1 - u),
                   far = std::ldexp(1, i % 6 - 3);
      Point origin;
      for (std::size_t k = 0; k < 3; ++k)
        origin[k] = at[k] + u * (corners[1][k] - at[k]) + v * (corners[2][k] - at[k]) - far * direction[k];
      list.origins.push_back(origin);
      list.directions.push_back(direction);
    }
  }
  holds(mesh, list);
}

// Through vertices from so far off that a coordinate's last place is more than the scene.
TEST_P(DoubleScenes, RaysFromFarAwayHitWhatRationalsSay) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 3);
  const DoubleMesh mesh = ring(9, 7, {0.5, 0.25, -0.5}, 1, random);
  RayList list;
  for (const int exponent : {30, 45, 52, 70})
    for (int i = 0; i < 200; ++i) {
      const double way = std::ldexp(1, exponent);
      Point at = mesh.corner(random() % mesh.size(), 0), direction{};
      for (std::size_t k = 0; k < 3; ++k) {
        at[k] = std::ldexp(std::round(std::ldexp(at[k], 52 - exponent)), exponent - 52);
        direction[k] = static_cast<double>(random() % 9) - 4;
      }
      if (direction == Point{}) direction[0] = 1;
      Point origin;
      for (std::size_t k = 0; k < 3; ++k) origin[k] = at[k] - way * direction[k];
      list.origins.push_back(origin);
      list.directions.push_back(direction);
    }
  holds(mesh, list);
}

// Intervals that end where something is hit, or a last place beside it.
TEST_P(DoubleScenes, IntervalsEndAtTheDoublesTold) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 4);
  DoubleMesh mesh = ring(9, 7, {1e3, 0, 0}, 1, random);
  add(mesh, ring(9, 7, {1e3, 0, 0}, 1.5, random));
  RayList list = aimed(mesh, 600, 1, random);
  const Scene scene = scene_of(mesh);
  const AllHits all = scene.all(list.rays());
  const auto beside = [&](std::size_t i, double otherwise) {
    const std::size_t n = all.splits[i + 1] - all.splits[i];
    if (n == 0 || random() % 4 == 0) return otherwise;
    const double t = all.t[all.splits[i] + random() % n];
    const int side = static_cast<int>(random() % 3) - 1;
    return side == 0 ? t : std::nextafter(t, side * kInfinity);
  };
  for (std::size_t i = 0; i < list.origins.size(); ++i) {
    list.t_min.push_back(beside(i, 0));
    list.t_max.push_back(beside(i, kInfinity));
  }
  const std::size_t n = list.origins.size();
  std::vector<double> t(n), u(n), v(n);
  std::vector<std::uint32_t> primitive(n);
  std::vector<std::uint8_t> any(n);
  scene.closest(list.rays(), {.t = t, .primitive = primitive, .u = u, .v = v});
  scene.any(list.rays(), any);
  many_agree(scene, list, t, primitive, u, v, any);
  std::vector<std::uint32_t> counts(n);
  scene.count(list.rays(), counts);
  many_count(scene, list, counts, scene.all(list.rays()));
  std::size_t n_hit = 0;
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t at = all.splits[i];
    while (at < all.splits[i + 1] && !(all.t[at] > list.t_min[i])) ++at;
    const bool hit = at < all.splits[i + 1] && all.t[at] < list.t_max[i];
    ASSERT_EQ(any[i], hit) << i;
    ASSERT_EQ(t[i], hit ? all.t[at] : kInfinity) << i;
    n_hit += hit;
  }
  EXPECT_GT(n_hit, 50u);
}

// Ends that no float holds, in a packet with others.
TEST_P(DoubleScenes, IntervalsMayEndAnywhere) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 9);
  const DoubleMesh mesh = ring(9, 7, {1e3, 0, 0}, 1, random);
  for (const double away : {0.5, 1e4}) {
    RayList list = aimed(mesh, 500, 1, random);
    for (std::size_t i = 0; i < list.origins.size(); ++i) {
      const Point& at = mesh.corner(i % mesh.size(), i % 3);
      list.origins[i] = {at[0] + 0.1, at[1], at[2] + away};
      for (std::size_t k = 0; k < 3; ++k) list.directions[i][k] = at[k] - list.origins[i][k];
      constexpr double kMost = std::numeric_limits<double>::max();
      const double begin[] = {0, -1e300, -kMost, 0, 0, 1e300, -1e-300};
      const double end[] = {kInfinity, 1e300, kMost, -kInfinity, -1e300, kInfinity, 1e-300};
      list.t_min.push_back(begin[i % 7]);
      list.t_max.push_back(end[i % 7]);
    }
    holds(mesh, list);
  }
}

// Rays of before (Renderer) ask such a scene as they ask any other.
TEST_P(DoubleScenes, FloatsOfOneAreTracedAsEver) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 10);
  const DoubleMesh mesh = ring(9, 7, {1e3, 0, 0}, 1, random);
  const RayList list = aimed(mesh, 500, 1, random);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < list.origins.size(); ++i) {
    const Point &o = list.origins[i], &d = list.directions[i];
    const auto f = [](double v) { return static_cast<float>(v); };
    rays.push_back({{f(o[0]), f(o[1]), f(o[2])}, 0, {f(d[0]), f(d[1]), f(d[2])}, HUGE_VALF});
  }
  CommitOptions in_floats = options();
  in_floats.tree.geometry = VertexPrecision::float32;
  Scene floats, doubles = scene_of(mesh);
  floats.add_mesh({mesh.points(), mesh.triangles});
  floats.commit(in_floats);
  const DeviceOptions device = options().device;
  const std::vector<Hit> expected = Renderer(floats.prepared(), device).trace(rays),
                         hits = Renderer(doubles.prepared(), device).trace(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(hits[i].primitive, expected[i].primitive) << i;
    ASSERT_EQ(hits[i].t, expected[i].t) << i;
  }
}

TEST_P(DoubleScenes, ParityOfClosedMeshesIsEven) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 1);
  DoubleMesh mesh = ring(30, 20, {1e5, 1e5, 0}, 1e-3, random);
  add(mesh, ring(30, 20, {1e5, 1e5, 0}, 1e-3 * (1 + 1e-12), random));
  const RayList list = aimed(mesh, 20000, 1e-3, random);
  const Scene scene = scene_of(mesh);
  std::vector<std::uint32_t> counts(list.origins.size());
  RayList from_outside = list;
  for (std::size_t i = 0; i < counts.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) from_outside.origins[i][k] -= 1e3 * list.directions[i][k];
  scene.count(from_outside.rays(), counts);
  std::size_t n_hit = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double reach = std::hypot(list.directions[i][0], list.directions[i][1], list.directions[i][2]);
    if (1e3 * reach < 1) continue;  // it may begin inside
    ASSERT_EQ(counts[i] % 2, 0) << i;
    n_hit += counts[i] > 0;
  }
  EXPECT_GT(n_hit, 1000u);
}

TEST_P(DoubleScenes, PointsAreMeasuredToTheDoubles) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 2);
  const DoubleMesh mesh = ring(9, 7, {1e6, -2e6, 3e6}, 1e-4, random);
  const Scene scene = scene_of(mesh);
  // Beside the middle of a face, to either side of it.
  std::vector<Point> points;
  std::vector<std::uint32_t> face;
  for (std::uint32_t i = 0; i < mesh.size(); ++i)
    for (const double side : {-1.0, 1.0}) {
      const Point &a = mesh.corner(i, 0), &b = mesh.corner(i, 1), &c = mesh.corner(i, 2);
      Point e, f, n, at;
      for (std::size_t k = 0; k < 3; ++k) e[k] = b[k] - a[k], f[k] = c[k] - a[k];
      for (std::size_t k = 0; k < 3; ++k)
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
      const double length = std::hypot(n[0], n[1], n[2]);
      for (std::size_t k = 0; k < 3; ++k) at[k] = a[k] + (e[k] + f[k]) / 3 + side * 4e-9 * n[k] / length;
      points.push_back(at);
      face.push_back(i);
    }
  const Points given(&points.front()[0], points.size(), sizeof(Point));
  std::vector<double> distance(points.size()), with_sign(points.size());
  std::vector<std::uint32_t> primitive(points.size());
  std::vector<std::uint8_t> inside(points.size());
  scene.closest_points(given, {.distance = distance, .primitive = primitive});
  scene.inside(given, inside);
  scene.signed_distance(given, with_sign);
  for (std::size_t i = 0; i < points.size(); ++i) {
    SCOPED_TRACE(i);
    const Exact p = exact(points[i]);
    const Exact a = minus(exact(mesh.corner(face[i], 0)), p), b = minus(exact(mesh.corner(face[i], 1)), p),
                c = minus(exact(mesh.corner(face[i], 2)), p);
    const Exact e = minus(b, a), f = minus(c, a);
    mpq_class n2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const mpq_class n = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
      n2 += n * n;
    }
    const mpq_class v = volume(a, b, c);
    const double wanted = std::sqrt(mpq_class(v * v / n2).get_d());
    ASSERT_EQ(primitive[i], face[i]);
    ASSERT_NEAR(distance[i], wanted, 1e-12 * wanted);
    ASSERT_EQ(std::abs(with_sign[i]), distance[i]);
    ASSERT_EQ(with_sign[i] < 0, inside[i] == 1);
    std::vector<Crossing> ahead = Line(points[i], {0.31, 0.57, 1}).crossings(mesh);
    std::erase_if(ahead, [](const Crossing& hit) { return hit.t < 0; });
    ASSERT_EQ(inside[i], ahead.size() % 2);
  }
}

}  // namespace
}  // namespace kdray
