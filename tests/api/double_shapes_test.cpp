// Shapes in scenes of doubles: every answer against GMP's floats of 512 bits, over shapes and rays as they
// were given: what is hit, how often, and where.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "api/double_scenes.h"
#include "api/shape_oracle.h"
#include "support/errors.h"

namespace kdray {
namespace {

using namespace test::doubles;
using test::Point;

constexpr unsigned kSeed = 441;

// Of one kind; so many that each test shows them in few seconds.
struct ShapeList {
  std::vector<TestShape> shapes;

  GeometryId add_to(Scene& scene) const {
    const ShapeKind& kind = shape_kind(kShapeNames[shapes.front().kind]);
    std::vector<double> columns[4];
    for (const TestShape& s : shapes) {
      columns[0].insert(columns[0].end(), s.a.begin(), s.a.end());
      columns[1].insert(columns[1].end(), s.b.begin(), s.b.end());
      columns[2].push_back(s.r0);
      columns[3].push_back(s.r1);
    }
    Shapes added{kind.name, {}};
    std::size_t n_vectors = 0, n_numbers = 0;
    for (const ShapeKind::Field& field : kind.fields)
      if (field.is_vector)
        added.fields.push_back({field.name, Points(columns[n_vectors++])});
      else
        added.fields.push_back({field.name, Values(columns[2 + n_numbers++])});
    return scene.add_shapes(added);
  }
};

class DoubleShapes : public OnEachDevice {
 protected:
  std::mt19937 random_{kSeed};
  std::size_t n_asked_ = 0, n_hits_ = 0;  // by holds()

  void TearDown() override { EXPECT_GE(n_hits_, n_asked_ / 5); }

  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  Point anywhere(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }
  static Point moved(const Point& from, double by, const Point& way) {
    return {from[0] + by * way[0], from[1] + by * way[1], from[2] + by * way[2]};
  }

  ShapeList some(TestShape::Kind kind, std::size_t n, const Point& center, double size) {
    ShapeList list;
    for (std::size_t i = 0; i < n; ++i) {
      const Point a = moved(center, size, anywhere(1)), way = anywhere(1);
      const double r = size * between(0.02, 0.2);
      TestShape s{kind, a, way, r, r * between(0, 1)};
      if (kind == TestShape::cone || kind == TestShape::capsule) s.b = moved(a, 0.3 * size, way);
      if (kind == TestShape::torus) s.r1 = r * between(0.05, 0.9);
      list.shapes.push_back(s);
    }
    return list;
  }

  static bool has_ends(const TestShape& s) {
    return s.kind == TestShape::cone || s.kind == TestShape::capsule;
  }

  // Somewhere near the surface: about a place of the axis, or of a torus' circle.
  Point place_near(const TestShape& s) {
    const double share = has_ends(s) ? between(0, 1) : 0;
    Point at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = has_ends(s) ? s.a[k] + share * (s.b[k] - s.a[k]) : s.a[k];
    if (s.kind != TestShape::torus) return moved(at, 1.2 * s.r0, anywhere(1));
    const Point way = anywhere(1);
    const double size = std::hypot(s.b[0], s.b[1], s.b[2]), x = s.b[0] / size, y = s.b[1] / size,
                 z = s.b[2] / size;
    const Point across{y * way[2] - z * way[1], z * way[0] - x * way[2], x * way[1] - y * way[0]};
    return moved(moved(at, s.r0 / std::hypot(across[0], across[1], across[2]), across), s.r1, anywhere(1));
  }

  // From near and far, and along axes.
  RayList aimed(const ShapeList& list, std::size_t n, double size) {
    RayList rays;
    for (std::size_t i = 0; i < n; ++i) {
      const Point target = place_near(list.shapes[random_() % list.shapes.size()]);
      Point way = anywhere(1);
      if (i % 5 == 0) way = {0, 0, i % 2 == 0 ? 1.0 : -1.0};
      const double far = size * std::array{0.01, 3.0, 1e4, 1e9, 1e13, 1e18, 1e25}[i % 7];
      rays.origins.push_back(moved(target, -far, way));
      rays.directions.push_back(i % 3 == 0 ? moved({0, 0, 0}, 1e6, way) : way);
    }
    return rays;
  }

  // Along a sphere, nearer to it than floats can tell, on either side.
  void add_touching(const TestShape& sphere, std::size_t n, RayList& to) {
    for (std::size_t i = 0; i < n; ++i) {
      const Point way = anywhere(1);
      const double length = std::hypot(way[0], way[1], way[2]);
      const Point place = moved(sphere.a, sphere.r0 * (1 + between(-1e-10, 1e-10)) / length, way);
      const Point along{way[1], -way[0], 0};
      to.origins.push_back(moved(place, -3, along));
      to.directions.push_back(along);
    }
  }

  Scene scene_of(const ShapeList& list) const {
    Scene scene;
    list.add_to(scene);
    scene.commit(options());
    return scene;
  }

  // So many rays that the device looks at them first: packets of one ray's copies, and of others.
  static void many_agree(const Scene& scene, const RayList& rays) {
    const std::size_t n = rays.origins.size(), copies = kMany / n + 1;
    std::vector<double> t(n), many_t(n * copies);
    std::vector<std::uint32_t> counts(n), many_counts(n * copies);
    std::vector<std::uint8_t> any(n), many_any(n * copies);
    scene.closest(rays.rays(), {.t = t});
    scene.count(rays.rays(), counts);
    scene.any(rays.rays(), any);
    const AllHits all = scene.all(rays.rays());
    for (const bool in_row : {false, true}) {
      const auto of = [&](std::size_t i) { return in_row ? i / copies : i % n; };
      RayList many;
      for (std::size_t i = 0; i < n * copies; ++i) {
        many.origins.push_back(rays.origins[of(i)]);
        many.directions.push_back(rays.directions[of(i)]);
      }
      scene.closest(many.rays(), {.t = many_t});
      scene.count(many.rays(), many_counts);
      scene.any(many.rays(), many_any);
      const AllHits many_all = scene.all(many.rays());
      for (std::size_t i = 0; i < n * copies; ++i) {
        ASSERT_EQ(many_t[i], t[of(i)]) << of(i);
        ASSERT_EQ(many_counts[i], counts[of(i)]) << of(i);
        ASSERT_EQ(many_any[i], any[of(i)]) << of(i);
        const std::uint64_t begin = all.splits[of(i)], end = all.splits[of(i) + 1];
        ASSERT_EQ(many_all.splits[i + 1] - many_all.splits[i], end - begin) << of(i);
        for (std::uint64_t k = begin; k < end; ++k)
          ASSERT_EQ(many_all.t[many_all.splits[i] + k - begin], all.t[k]) << of(i);
      }
    }
  }

  // Of rays that begin on a shape of size 1 t may be as small as what pairs of doubles lose.
  static bool is_near(double t, const Float& right) {
    return places_off(t, mpq_class(right)) <= 2 || std::abs(Float(t - right).get_d()) < 0x1p-96;
  }

  void holds(const ShapeList& list, const RayList& rays) {
    const Scene scene = scene_of(list);
    const std::size_t n = rays.origins.size();
    std::vector<double> t(n), u(n);
    std::vector<std::uint32_t> primitive(n), counts(n);
    std::vector<std::uint8_t> any(n);
    scene.closest(rays.rays(), {.t = t, .primitive = primitive, .u = u});
    scene.any(rays.rays(), any);
    scene.count(rays.rays(), counts);
    const AllHits all = scene.all(rays.rays());
    std::size_t n_hits = 0;
    for (std::size_t i = 0; i < n; ++i) {
      SCOPED_TRACE(i);
      const double t_min = rays.t_min.empty() ? 0 : rays.t_min[i];
      const double t_max = rays.t_max.empty() ? kInfinity : rays.t_max[i];
      std::vector<ShapeCrossing> found =
          ShapeLine(rays.origins[i], rays.directions[i]).crossings(list.shapes);
      std::erase_if(found, [&](const ShapeCrossing& c) {
        return c.t <= t_min || (std::isfinite(t_max) && c.t >= t_max);
      });
      n_hits += found.size();
      ASSERT_EQ(counts[i], found.size());
      ASSERT_EQ(all.splits[i + 1] - all.splits[i], found.size());
      ASSERT_EQ(any[i], found.empty() ? 0 : 1);
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_EQ(all.primitive[all.splits[i] + k], found[k].shape);
        ASSERT_TRUE(is_near(all.t[all.splits[i] + k], found[k].t));
      }
      if (found.empty()) {
        ASSERT_TRUE(std::isinf(t[i]));
        continue;
      }
      ASSERT_EQ(primitive[i], found[0].shape);
      ASSERT_TRUE(is_near(t[i], found[0].t));
      ASSERT_NEAR(u[i], found[0].u, 1e-12);
    }
    n_asked_ += n, n_hits_ += n_hits;
  }
};
KDRAY_FOR_EACH_DEVICE(DoubleShapes);

constexpr TestShape::Kind kKinds[] = {TestShape::sphere, TestShape::cone, TestShape::disc, TestShape::torus,
                                      TestShape::capsule};

// A kind that is added needs its equation in shape_oracle.h.
TEST(DoubleShapeKinds, AreAllAsked) {
  for (const ShapeKind& kind : shape_kinds())
    EXPECT_EQ(std::ranges::count(kShapeNames, kind.name), 1) << kind.name;
  EXPECT_EQ(std::size(kKinds), std::size(kShapeNames));
}

TEST_P(DoubleShapes, AreHitAsTheirEquationsSay) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind : kKinds)
    for (const auto& [center, size] :
         {std::pair<Point, double>{{0, 0, 0}, 1}, {{4.1e6, -3.3e6, 51.7}, 30}, {{0.1, 0.2, 0.3}, 1e-12}}) {
      SCOPED_TRACE(kShapeNames[kind]);
      SCOPED_TRACE(size);
      const ShapeList list = some(kind, kind == TestShape::torus ? 6 : 12, center, size);
      holds(list, aimed(list, 300, size));
    }
}

// Between two surfaces, behind the start, and up to the last place of a hit.
TEST_P(DoubleShapes, AreHitBetweenTMinAndTMax) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind : kKinds) {
    SCOPED_TRACE(kShapeNames[kind]);
    const ShapeList list = some(kind, 12, {7, -8, 9}, 1);
    RayList rays = aimed(list, 150, 1);
    const AllHits all = scene_of(list).all(rays.rays());
    for (std::size_t i = 0; i < rays.origins.size(); ++i) {
      const std::uint64_t n = all.splits[i + 1] - all.splits[i];
      const double t = n > 0 ? all.t[all.splits[i] + random_() % n] : 1;
      const double before = t * (1 - 0x1p-50), behind = t * (1 + 0x1p-50);
      const std::array<std::pair<double, double>, 4> spans{
          {{before, kInfinity}, {-1e30, behind}, {behind, kInfinity}, {-behind, before}}};
      rays.t_min.push_back(spans[i % 4].first);
      rays.t_max.push_back(spans[i % 4].second);
    }
    holds(list, rays);
    // Behind a hit by its t as told.
    std::vector<std::uint32_t> after(rays.origins.size());
    for (std::size_t i = 0; i < after.size(); ++i) {
      const auto first = all.t.begin() + static_cast<std::ptrdiff_t>(all.splits[i]),
                 last = all.t.begin() + static_cast<std::ptrdiff_t>(all.splits[i + 1]);
      rays.t_min[i] = first == last ? 0 : *first;
      rays.t_max[i] = kInfinity;
      after[i] = static_cast<std::uint32_t>(std::count_if(first, last, [&](double t) { return t > *first; }));
    }
    std::vector<std::uint32_t> counts(after.size());
    scene_of(list).count(rays.rays(), counts);
    EXPECT_EQ(counts, after);
  }
}

// Grazing rays of shapes that are tiny beside where they lie.
TEST_P(DoubleShapes, MayBeTiny) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind : kKinds)
    for (const double size : {1e-6, 1e-9}) {
      SCOPED_TRACE(kShapeNames[kind]);
      SCOPED_TRACE(size);
      ShapeList list = some(kind, 6, {1050.9263984739025, -1478.199007893126, 1020.4178285030102}, size);
      TestShape far = list.shapes[0];
      for (std::size_t k = 0; k < 3; ++k)
        far.a[k] -= 2000, far.b[k] -= far.kind == TestShape::disc ? 0 : 2000;
      list.shapes.push_back(far);
      RayList rays = aimed(list, 200, size);
      holds(list, rays);
    }
}

// The same shapes without one of their parts.
TEST_P(DoubleShapes, MayHaveNoLengthOrATip) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind :
       {TestShape::capsule, TestShape::cone, TestShape::disc, TestShape::torus}) {
    SCOPED_TRACE(kShapeNames[kind]);
    ShapeList list = some(kind, 12, {0.25, 0.5, 0.75}, 1);
    for (std::size_t i = 0; i < list.shapes.size(); ++i) {
      TestShape& s = list.shapes[i];
      if (kind == TestShape::capsule) s.b = s.a;
      if (kind == TestShape::cone) (i % 2 == 0 ? s.r0 : s.r1) = 0, s.r0 += i % 2 == 0 ? 0 : 0.1;
      const double longer = i % 2 == 0 ? 1e-300 : 1e150;
      if (kind == TestShape::disc || kind == TestShape::torus) s.b = moved({0, 0, 0}, longer, s.b);
      if (kind == TestShape::torus) s.r1 = s.r0 / 4000;
    }
    holds(list, aimed(list, 300, 1));
  }
}

// Rays that begin on a surface, or as near to it as doubles can be, and go along it or anywhere: what is
// ahead is told by the side that they are on. And rays that all but touch a shape, or its rim.
TEST_P(DoubleShapes, AreHitRightByRaysThatBeginOnThemOrTouchThem) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind : kKinds) {
    SCOPED_TRACE(kShapeNames[kind]);
    const ShapeList list = some(kind, 1, {0.3, 0.1, -0.7}, 1);
    const Scene scene = scene_of(list);
    RayList first = aimed(list, 200, 1), rays;
    std::vector<double> t(first.origins.size());
    std::vector<Point> normals(t.size()), points(t.size());
    scene.closest(first.rays(), {.t = t,
                                 .normal = {&normals[0][0], normals.size(), sizeof(Point)},
                                 .point = {&points[0][0], points.size(), sizeof(Point)}});
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (std::isinf(t[i])) continue;
      rays.origins.push_back(points[i]);
      rays.directions.push_back(anywhere(1));
      const Point &n = normals[i], way = anywhere(1);
      const Point along{n[1] * way[2] - n[2] * way[1], n[2] * way[0] - n[0] * way[2],
                        n[0] * way[1] - n[1] * way[0]};
      // What a torus is touched by is decided in doubles.
      const double off = kind == TestShape::torus ? 1e-9 : 1e-16;
      rays.origins.push_back(moved(moved(points[i], -3, along), between(-off, off), n));
      rays.directions.push_back(along);
    }
    holds(list, rays);
  }
}

// The rounding of its ends to floats would tilt such a cone by up to a right angle.
TEST_P(DoubleShapes, ConesMayBeFarWiderThanTheyAreHigh) {
  SCOPED_TRACE(kSeed);
  ShapeList list = some(TestShape::cone, 12, {0.1, -0.2, 0.3}, 1);
  for (std::size_t i = 0; i < list.shapes.size(); ++i) {
    TestShape& s = list.shapes[i];
    s.b = moved(s.a, std::array{1e-4, 3e-7, 1e-9, 1e-12}[i % 4], {between(-0.5, 0.5), between(-0.5, 0.5), 1});
    s.r0 = between(0.5, 1), s.r1 = between(0.1, 0.5);
  }
  holds(list, aimed(list, 600, 1));
}

// Exactly through the tip: a line that is steeper than the cone crosses it there once, others never alone.
TEST_P(DoubleShapes, ConesAreCrossedOnceThroughTheirTip) {
  SCOPED_TRACE(kSeed);
  std::uniform_int_distribution<int> whole(-9, 9);
  const auto any_whole = [&] {
    return Point{double(whole(random_)), double(whole(random_)), double(whole(random_))};
  };
  std::size_t n_steep = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Point tip = any_whole(), axis = any_whole(), way = any_whole();
    const auto times = [](const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const double length2 = times(axis, axis), along = times(axis, way), radius = 1 + 4 * (i % 7);
    if (length2 == 0 || along == 0) continue;
    const Point base = moved(tip, -1, axis);
    Scene scene;
    const std::vector<double> wide_end{radius}, tip_end{0};
    i % 2 == 0 ? scene.add_cones({Points(&base[0], 1), Points(&tip[0], 1), wide_end, tip_end})
               : scene.add_cones({Points(&tip[0], 1), Points(&base[0], 1), tip_end, wide_end});
    scene.commit(options());
    const double wide =
        (times(way, way) * length2 - along * along) * length2 - radius * radius * along * along;
    const Point origin = moved(tip, -2, way);
    std::uint32_t count = 0;
    double t = 0;
    scene.count({Points(&origin[0], 1), Points(&way[0], 1)}, {&count, 1});
    scene.closest({Points(&origin[0], 1), Points(&way[0], 1)}, {.t = {&t, 1}});
    if (wide >= 0) {
      EXPECT_TRUE(wide == 0 || count % 2 == 0) << count;
      continue;
    }
    ++n_steep;
    EXPECT_EQ(count, 1);
    EXPECT_EQ(t, 2);
  }
  EXPECT_GT(n_steep, 50);
}

TEST_P(DoubleShapes, MayLieAmongTriangles) {
  SCOPED_TRACE(kSeed);
  const Point center{1e3, 2e3, -7e2};
  const DoubleMesh mesh = ring(12, 9, center, 1, random_);
  std::vector<ShapeList> lists;
  std::vector<TestShape> shapes;
  Scene scene;
  scene.add_mesh({mesh.points(), mesh.triangles});
  std::vector<std::uint32_t> first;
  for (const TestShape::Kind kind : kKinds) {
    lists.push_back(some(kind, 3, center, 1));
    lists.back().add_to(scene);
    shapes.insert(shapes.end(), lists.back().shapes.begin(), lists.back().shapes.end());
  }
  const CommitReport report = scene.commit(options());
  EXPECT_EQ(report.geometry, VertexPrecision::float64);
  ShapeList all_shapes{shapes};
  RayList rays = test::doubles::aimed(mesh, 400, 1, random_);
  const RayList others = aimed(all_shapes, 400, 1);
  rays.origins.insert(rays.origins.end(), others.origins.begin(), others.origins.end());
  rays.directions.insert(rays.directions.end(), others.directions.begin(), others.directions.end());
  for (std::size_t i = 0; i < 3; ++i) add_touching(shapes[i], 100, rays);
  const std::size_t n = rays.origins.size();
  std::vector<double> t(n);
  std::vector<std::uint32_t> geometry(n), primitive(n), counts(n);
  scene.closest(rays.rays(), {.t = t, .geometry = geometry, .primitive = primitive});
  scene.count(rays.rays(), counts);
  const AllHits all = scene.all(rays.rays());
  struct Hit {
    mpq_class t;
    std::uint32_t geometry, primitive;
  };
  std::size_t n_of_shapes = 0, n_of_triangles = 0;
  for (std::size_t i = 0; i < n; ++i) {
    SCOPED_TRACE(i);
    std::vector<Hit> found;
    for (const Crossing& c : Line(rays.origins[i], rays.directions[i]).crossings(mesh))
      found.push_back({c.t, 0, c.triangle});
    for (const ShapeCrossing& c : ShapeLine(rays.origins[i], rays.directions[i]).crossings(shapes))
      found.push_back({mpq_class(c.t), 1 + c.shape / 3, c.shape % 3});
    std::stable_sort(found.begin(), found.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
    std::erase_if(found, [](const Hit& h) { return h.t < 0; });
    ASSERT_EQ(counts[i], found.size());
    ASSERT_EQ(all.splits[i + 1] - all.splits[i], found.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      ASSERT_EQ(all.geometry[all.splits[i] + k], found[k].geometry);
      ASSERT_EQ(all.primitive[all.splits[i] + k], found[k].primitive);
    }
    std::erase_if(found, [](const Hit& h) { return h.t == 0; });
    if (found.empty()) {
      ASSERT_TRUE(std::isinf(t[i]));
      continue;
    }
    (found[0].geometry == 0 ? n_of_triangles : n_of_shapes)++;
    ASSERT_EQ(geometry[i], found[0].geometry);
    ASSERT_EQ(primitive[i], found[0].primitive);
    ASSERT_LE(places_off(t[i], found[0].t), 2);
  }
  EXPECT_GT(n_of_triangles, 100);
  EXPECT_GT(n_of_shapes, 100);
  many_agree(scene, rays);
}

TEST_P(DoubleShapes, DistancesAndInsidesAreThoseOfTheirEquations) {
  SCOPED_TRACE(kSeed);
  for (const TestShape::Kind kind : kKinds) {
    SCOPED_TRACE(kShapeNames[kind]);
    ShapeList list = some(kind, 20, {1e5, 0, -1e5}, 1);
    const Scene scene = scene_of(list);
    std::vector<double> points;
    for (std::size_t i = 0; i < 200; ++i) {
      const Point p = place_near(list.shapes[random_() % list.shapes.size()]);
      points.insert(points.end(), p.begin(), p.end());
    }
    // In the middle of one, on its axis, and far outside of the scene, on the line that counts through it.
    const TestShape& s = list.shapes[3];
    for (const double along : {0.0, 0.1, 2.0})
      for (std::size_t k = 0; k < 3; ++k)
        points.push_back(s.a[k] + along * (s.b[k] - (has_ends(s) ? s.a[k] : 0)));
    for (std::size_t k = 0; k < 3; ++k) points.push_back(s.a[k] - 50 * std::array{0.1803f, 0.2741f, 1.0f}[k]);
    const std::size_t n = points.size() / 3;
    std::vector<double> distance(n), of_sign(n);
    std::vector<Point> nearest(n);
    std::vector<std::uint32_t> primitive(n);
    std::vector<std::uint8_t> inside(n);
    scene.closest_points(
        Points(points),
        {.distance = distance, .point = {&nearest[0][0], n, sizeof(Point)}, .primitive = primitive});
    scene.inside(Points(points), inside);
    scene.signed_distance(Points(points), of_sign);
    for (std::size_t i = 0; i < n; ++i) {
      SCOPED_TRACE(i);
      const Point p{points[3 * i], points[3 * i + 1], points[3 * i + 2]};
      ShapeDistance best = distance_to(list.shapes[0], p);
      bool within = false;
      std::uint32_t which = 0;
      for (std::uint32_t k = 0; k < list.shapes.size(); ++k) {
        const ShapeDistance here = distance_to(list.shapes[k], p);
        within ^= here.inside;
        if (here.surface < best.surface) best = here, which = k;
      }
      ASSERT_NEAR(distance[i], best.surface.get_d(), 1e-14 * (1 + distance[i]));
      ASSERT_EQ(primitive[i], which);
      ASSERT_LT(distance_to(list.shapes[which], nearest[i]).surface.get_d(), 1e-10);
      ASSERT_NEAR(std::sqrt(dot(big(p) - big(nearest[i]), big(p) - big(nearest[i])).get_d()), distance[i],
                  1e-10);
      ASSERT_TRUE(i + 1 < n || inside[i] == 0);
      if (kind == TestShape::cone || kind == TestShape::disc) continue;
      ASSERT_EQ(inside[i], within);
      ASSERT_EQ(of_sign[i], within ? -distance[i] : distance[i]);
    }
  }
}

// Two triangles of one t as told, the nearer with the higher number: a sphere behind them changes nothing.
TEST_P(DoubleShapes, LeaveTrianglesInTheirOrder) {
  Scene scene;
  const std::vector<double> vertices{-1, -1, 1 + 1e-10, 1, -1, 1 + 1e-10, 0, 1, 1 + 1e-10,
                                     -1, -1, 1,         1, -1, 1,         0, 1, 1};
  scene.add_mesh({vertices, std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}});
  scene.add_spheres({std::vector<double>{0, 0, 5}, std::vector<double>{0.1}});
  scene.commit(options());
  const std::vector<double> origins{0.01, 0.02, -1e9}, directions{0, 0, 1};
  const Rays ray{Points(origins), Points(directions)};
  std::uint32_t primitive = 0;
  double t = 0;
  scene.closest(ray, {.t = {&t, 1}, .primitive = {&primitive, 1}});
  const AllHits all = scene.all(ray);
  ASSERT_EQ(all.t.size(), 4);
  EXPECT_EQ(all.t[0], all.t[1]);
  EXPECT_EQ(all.t[0], t);
  EXPECT_EQ(primitive, 1);
  EXPECT_EQ(all.primitive[0], 1);
  EXPECT_EQ(all.primitive[1], 0);
}

TEST_P(DoubleShapes, MayBeCopiesAndHaveMasks) {
  Scene scene;
  GeometryOptions prototype;
  prototype.prototype = true;
  const GeometryId ball =
      scene.add_spheres({std::vector<double>{0, 0, 0}, std::vector<double>{0.1}}, prototype);
  const std::vector<double> places{1, 0, 0, 1e8, 0, 1, 0, 0, 0, 0, 1, 0,
                                   1, 0, 0, 1e8, 0, 1, 0, 0, 0, 0, 1, 3};
  scene.add_instances(ball, Transforms(places), {.mask = 1});
  GeometryOptions masked;
  masked.mask = 2;
  scene.add_spheres({std::vector<double>{1e8, 0, -3}, std::vector<double>{0.25}}, masked);
  scene.commit(options());
  const std::vector<double> origins{1e8, 0, -10}, directions{0, 0, 1};
  double t = 0;
  for (const std::uint32_t mask : {1u, 2u, 3u, 4u}) {
    scene.closest({Points(origins), Points(directions), {}, {}, Words(&mask, 1)}, {.t = {&t, 1}});
    EXPECT_EQ(t, mask == 4 ? kInfinity : (mask & 2) != 0 ? 6.75 : 10 - 0.1) << mask;
  }
}

}  // namespace
}  // namespace kdray
