// What    Renderer::trace against brute force in double precision: closest hits and occlusion of random,
//         axis-parallel and limited rays, and what happens to rays that are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "conformance/samples.h"
#include "oracle/build_scene.h"
#include "oracle/oracle.h"
#include "pictures/render.h"
#include "pictures/scenes.h"
#include "support/data.h"

namespace kdray::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Random rays about a scene: from inside its bounds, and from around it towards it.
class RayMaker {
 public:
  RayMaker(const scene::Scene& scene, unsigned seed) : random_(seed), box_(scene.bounds()) {}

  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  dvec3 point(double grown = 0) {
    const dvec3 e = grown * box_.extent();
    return {uniform(box_.lo.x - e.x, box_.hi.x + e.x), uniform(box_.lo.y - e.y, box_.hi.y + e.y),
            uniform(box_.lo.z - e.z, box_.hi.z + e.z)};
  }
  dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(random_), normal(random_), normal(random_)));
  }
  dvec3 axis() {
    dvec3 d(0);
    d[std::uniform_int_distribution<int>(0, 2)(random_)] = uniform(0, 1) < 0.5 ? -1 : 1;
    return d;
  }
  // Inside outwards, outside inwards, along an axis; lengths and intervals of all kinds.
  Ray ray(bool along_axis) {
    const bool inside = uniform(0, 1) < 0.5;
    const double size = glm::length(box_.extent());
    dvec3 d = direction(), o = point();
    if (along_axis) d = axis();
    if (!inside) o -= d * (size * uniform(0.5, 3));
    const double length = uniform(0, 1) < 0.5 ? 1 : std::exp(uniform(-5, 5));
    return make(o, d * length, 0, kInfinity);
  }
  static Ray make(const dvec3& o, const dvec3& d, float t_min, float t_max) {
    return {{static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z)},
            t_min,
            {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
            t_max};
  }

 private:
  std::mt19937 random_;
  DBox box_;
};

oracle::Ray in_double(const Ray& r) {
  return {{r.origin[0], r.origin[1], r.origin[2]},
          {r.direction[0], r.direction[1], r.direction[2]},
          r.t_min,
          r.t_max};
}

// Hits that hang on rounding (edges, silhouettes, coinciding surfaces) are told apart by growing and
// shrinking every primitive by a few float steps of the coordinates in play.
struct Judge {
  const oracle::World& world;
  dvec3 center;
  int certain = 0, uncertain = 0;

  double rounding(const oracle::Ray& ray) const {
    return 2e-6 * (world.extent() + glm::length(ray.origin - center));
  }

  // A surface where the ray begins (its origin lies on it, say) is met or not as rounding will have it.
  bool at_an_end(const oracle::Ray& ray, double step) const {
    oracle::Ray longer = ray;
    longer.t_min -= 10 * step / glm::length(ray.direction);
    const oracle::Hit hit = world.closest(longer);
    return hit.found() && hit.t < ray.t_min + 10 * step / glm::length(ray.direction);
  }

  void expect_closest(const Ray& given, const Hit& found) {
    const oracle::Ray ray = in_double(given);
    const double step = rounding(ray);
    const oracle::Hit wanted = world.closest(ray);
    if (world.closest(ray, step).primitive != wanted.primitive ||
        world.closest(ray, -step).primitive != wanted.primitive || at_an_end(ray, step)) {
      ++uncertain;
      return;
    }
    ++certain;
    if (!wanted.found()) {
      EXPECT_EQ(found.primitive, -1);
      EXPECT_EQ(found.t, kInfinity);
      return;
    }
    const oracle::Surface surface = world.surface(ray, wanted);
    const double speed = glm::length(ray.direction);
    const double cosine = std::abs(glm::dot(surface.outward, ray.direction)) / speed;
    const double apart = std::abs(found.t - wanted.t);
    EXPECT_LE(apart, 1e-5 * wanted.t + step / (cosine * speed)) << found.t << " instead of " << wanted.t;
    // Two surfaces at one place: either is right.
    const bool tie = found.primitive != wanted.primitive && apart <= step / (cosine * speed);
    if (tie) return;
    EXPECT_EQ(found.primitive, wanted.primitive);
    expect_position(ray, found, surface, step / cosine);
  }

  // u and v put a triangle's hit where t does.
  void expect_position(const oracle::Ray& ray, const Hit& found, const oracle::Surface& surface,
                       double slack) const {
    if (!surface.smooth) return;  // the corners are at hand for triangles with normals
    const dvec3 p = ray.origin + static_cast<double>(found.t) * ray.direction;
    const double u = found.u, v = found.v;
    const dvec3 q = (1 - u - v) * surface.corner[0] + u * surface.corner[1] + v * surface.corner[2];
    EXPECT_LE(glm::length(p - q), 4 * slack + 1e-5 * glm::length(p - ray.origin));
  }
};

std::vector<Ray> random_rays(const scene::Scene& model, unsigned seed, int n) {
  RayMaker maker(model, seed);
  std::vector<Ray> rays;
  for (int i = 0; i < n; ++i) rays.push_back(maker.ray(i % 4 == 0));
  return rays;
}

void expect_like_brute_force(const Scene& scene, unsigned seed, int n, double most_uncertain = 0.02) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  const std::vector<Ray> rays = random_rays(scene.model(), seed, n);
  Renderer renderer(scene, {}, device_of());
  const std::vector<Hit> hits = renderer.trace(rays);
  ASSERT_EQ(hits.size(), rays.size());
  const oracle::World world(scene.model());
  Judge judge{world, scene.model().bounds().center()};
  for (int i = 0; i < n; ++i) {
    SCOPED_TRACE(testing::Message() << "ray " << i);
    judge.expect_closest(rays[i], hits[i]);
  }
  EXPECT_LE(judge.uncertain, most_uncertain * n);
  const auto found = std::ranges::count_if(hits, [](const Hit& h) { return h.primitive >= 0; });
  EXPECT_GT(found, n / 20);
}

// Primitives of all kinds strewn about, sizes over three orders of magnitude, slivers among them.
scene::Scene soup(unsigned seed, int n) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&](double size) {
    return size * dvec3(uniform(random), uniform(random), uniform(random));
  };
  oracle::SceneBuilder b;
  const scene::Material any = oracle::matte(vec3(1));
  for (int i = 0; i < n; ++i) {
    const double size = std::pow(10, -1.7 + 1.2 * uniform(random));
    const dvec3 p = vector(1);
    if (i % 4 == 0) b.sphere(p, 0.5 * size, any);
    if (i % 4 == 1) b.cone(p, 0.3 * size, p + vector(size), 0.3 * size * std::abs(uniform(random)), any);
    if (i % 4 == 2) b.triangle(p, p + vector(size), p + vector(size), any);
    if (i % 4 == 3) b.triangle(p, p + vector(3 * size), p + vector(0.05 * size), any);
  }
  Draw draw(seed);
  b.change([&](scene::Scene& s) {
    for (int i = 0; i < n / 20; ++i)
      primitives::for_each_kind([&](auto kind) { Samples<decltype(kind)>::add(s, 0, draw); });
  });
  return b.scene();
}

TEST(Trace, SoupOfAllKinds) {
  expect_like_brute_force(Scene{soup(71, 1500)}, 72, 6000);
}

TEST(Trace, SmoothMeshesAndConesAndBalls) {
  unsigned seed = 80;
  for (const NamedScene& s : small_scenes()) {
    SCOPED_TRACE(s.name);
    // Far away a float ray's origin has few bits left, yet the ray it names is exact.
    expect_like_brute_force(Scene{s.make()}, ++seed, 1500, 0.05);
  }
}

TEST(Trace, ARealMesh) {
  const std::filesystem::path file = data_path("stanford/bunny_closed_75k.ply.xz");
  KDRAY_NEED_DATA(file);
  expect_like_brute_force(Scene::load(file), 91, 300, 0.05);
}

TEST(Trace, AnyHitSaysWhatClosestHitSays) {
  const Scene scene{soup(73, 600)};
  const std::vector<Ray> rays = random_rays(scene.model(), 74, 20000);
  Renderer renderer(scene, {}, device_of());
  const std::vector<Hit> closest = renderer.trace(rays), any = renderer.trace(rays, true);
  ASSERT_EQ(any.size(), rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool hit = closest[i].primitive >= 0;
    ASSERT_EQ(any[i].t, hit ? 0.0f : kInfinity) << "ray " << i;
    ASSERT_TRUE(hit || any[i].primitive == -1) << "ray " << i;
  }
}

// Cutting the ray before its hit, behind it, and around it.
TEST(Trace, IntervalsAreHonoured) {
  const Scene scene{soup(75, 600)};
  std::vector<Ray> rays = random_rays(scene.model(), 76, 4000);
  Renderer renderer(scene, {}, device_of());
  const std::vector<Hit> whole = renderer.trace(rays);
  std::vector<Ray> before = rays, around = rays, behind = rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const float t = std::isfinite(whole[i].t) ? whole[i].t : 1;
    before[i].t_max = 0.999f * t;
    around[i].t_min = 0.999f * t, around[i].t_max = 1.001f * t;
    behind[i].t_min = 1.001f * t;
  }
  const std::vector<Hit> none = renderer.trace(before), same = renderer.trace(around),
                         next = renderer.trace(behind);
  const std::vector<Hit> occluded = renderer.trace(before, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (whole[i].primitive < 0) continue;
    ASSERT_EQ(none[i].primitive, -1) << i;
    ASSERT_EQ(occluded[i].t, kInfinity) << i;
    ASSERT_EQ(same[i].primitive, whole[i].primitive) << i;
    ASSERT_EQ(same[i].t, whole[i].t) << i;
    ASSERT_GT(next[i].t, whole[i].t) << i;
  }
  const oracle::World world(scene.model());
  Judge judge{world, scene.model().bounds().center()};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "ray " << i << " from behind its first hit");
    if (whole[i].primitive >= 0) judge.expect_closest(behind[i], next[i]);
  }
  EXPECT_GT(judge.certain, 500);
}

TEST(Trace, TheLengthOfTheDirectionScalesT) {
  const Scene scene{glass_and_mirror_balls()};
  Renderer renderer(scene, {}, device_of());
  const Ray unit{{0.2f, 3, 7}, 0, {0, -0.25f, -0.5f}, kInfinity};
  Ray longer = unit;
  for (float& d : longer.direction) d *= 8;
  const std::vector<Hit> hits = renderer.trace(std::vector<Ray>{unit, longer});
  ASSERT_GE(hits[0].primitive, 0);
  EXPECT_EQ(hits[0].primitive, hits[1].primitive);
  EXPECT_NEAR(hits[0].t, 8 * hits[1].t, 1e-5f * hits[0].t);
}

// Directions of ordinary lengths are traced as they are, others scaled (query.clh); with some powers a launch
// has rays of both kinds.
TEST(Trace, NoLengthOfTheDirectionChangesABit) {
  const Scene scene{glass_and_mirror_balls()};
  Renderer renderer(scene, {}, device_of());
  RayMaker maker(scene.model(), 20261124);
  std::vector<Ray> rays;
  for (int i = 0; i < 500; ++i) rays.push_back(maker.make(maker.point(0.5), maker.direction(), 0, kInfinity));
  for (const Traversal walk : {Traversal::binary, Traversal::wide, Traversal::packet, Traversal::batch}) {
    const std::vector<Hit> wanted = renderer.trace(rays, false, 1, walk);
    for (const int power : {-100, -20, -9, -8, -7, 3, 7, 8, 9, 20, 100}) {
      std::vector<Ray> longer = rays;
      for (Ray& ray : longer)
        for (float& d : ray.direction) d = std::ldexp(d, power);
      const std::vector<Hit> hits = renderer.trace(longer, false, 1, walk);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "ray " << i << " times 2^" << power);
        ASSERT_EQ(hits[i].primitive, wanted[i].primitive);
        ASSERT_EQ(std::ldexp(hits[i].t, power), wanted[i].t);
        ASSERT_EQ(hits[i].u, wanted[i].u);
        ASSERT_EQ(hits[i].v, wanted[i].v);
      }
    }
  }
}

// A grid of squares in the planes x, y, z = -1, 0, 1, and axis rays exactly in and between those planes:
// splitting planes, cell walls and geometry coincide.
TEST(Trace, AxisRaysAlongSplittingPlanes) {
  oracle::SceneBuilder b;
  const scene::Material any = oracle::matte(vec3(1));
  for (int axis = 0; axis < 3; ++axis) {
    for (int plane = -1; plane <= 1; ++plane) {
      for (int i = 0; i < 16; ++i) {
        dvec3 corner(0), x(0), y(0);
        corner[axis] = plane;
        corner[(axis + 1) % 3] = -2 + i % 4, corner[(axis + 2) % 3] = -2 + i / 4;
        x[(axis + 1) % 3] = 1, y[(axis + 2) % 3] = 1;
        b.quad(corner, x, y, any);
      }
    }
  }
  const Scene scene{scene::Scene(b.scene())};
  std::vector<Ray> rays;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      for (const float zero : {0.0f, -0.0f}) {
        for (int i = 0; i < 17 * 17; ++i) {
          Ray r{{0, 0, 0}, 0, {zero, zero, zero}, kInfinity};
          r.origin[axis] = -5 * sign, r.direction[axis] = sign;
          r.origin[(axis + 1) % 3] = -2 + 0.25f * (i % 17), r.origin[(axis + 2) % 3] = -2 + 0.25f * (i / 17);
          rays.push_back(r);
        }
      }
    }
  }
  Renderer renderer(scene, {}, device_of());
  const std::vector<Hit> hits = renderer.trace(rays), any_hits = renderer.trace(rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // Every ray meets the first square of its own axis at distance 4: squares it runs along have no area to
    // it, and the outermost rays run along edges that belong to a square.
    ASSERT_NEAR(hits[i].t, 4, 1e-5) << "ray " << i;
    ASSERT_GE(hits[i].primitive, 0);
    ASSERT_EQ(any_hits[i].t, 0) << "ray " << i;
  }
}

// From inside a closed mesh, through every vertex and every edge's middle: nothing gets out.
TEST(Trace, NothingLeaksThroughVerticesAndEdges) {
  scene::Scene model;
  model.camera = scene::Camera{};
  add_smooth_ball(model, {0.1, 0.2, -0.3}, 1, 24, oracle::matte(vec3(1)));
  const Scene scene{scene::Scene(model)};
  std::vector<Ray> rays;
  const dvec3 inside{0.13, 0.21, -0.36};
  for (const scene::Triangle& t : model.triangles) {
    for (int k = 0; k < 3; ++k) {
      const dvec3 a = model.vertices[t.vertex[k]], b = model.vertices[t.vertex[(k + 1) % 3]];
      rays.push_back(RayMaker::make(inside, a - inside, 0, kInfinity));
      rays.push_back(RayMaker::make(inside, 0.5 * (a + b) - inside, 0, kInfinity));
    }
  }
  Renderer renderer(scene, {}, device_of());
  const std::vector<Hit> hits = renderer.trace(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_GE(hits[i].primitive, 0) << "ray " << i;
    ASSERT_NEAR(hits[i].t, 1, 1e-4) << "ray " << i;
  }
}

TEST(Trace, OfCoincidingTrianglesTheSmallerNumberIsHit) {
  oracle::SceneBuilder b;
  const scene::Material any = oracle::matte(vec3(1));
  for (int i = 0; i < 5; ++i) b.triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, any);
  const Scene scene{scene::Scene(b.scene())};
  Renderer renderer(scene, {}, device_of());
  for (const float from : {-3.0f, 3.0f}) {
    const Ray ray{{0.1f, 0.2f, from}, 0, {0, 0, -from}, kInfinity};
    EXPECT_EQ(renderer.trace(std::vector<Ray>{ray})[0].primitive, 0);
  }
}

TEST(Trace, ConesTellTheHeightOfTheHit) {
  oracle::SceneBuilder b;
  b.cone({0, 0, 0}, 1, {0, 4, 0}, 0.5, oracle::matte(vec3(1)));
  const Scene scene{scene::Scene(b.scene())};
  Renderer renderer(scene, {}, device_of());
  const Ray ray{{9, 1, 0}, 0, {-1, 0, 0}, kInfinity};
  const Hit hit = renderer.trace(std::vector<Ray>{ray})[0];
  EXPECT_NEAR(hit.u, 0.25, 1e-5);
  EXPECT_NEAR(hit.t, 9 - 0.875, 1e-5);
}

TEST(Trace, RaysThatAreNoneAreRefused) {
  const Scene scene{glass_and_mirror_balls()};
  Renderer renderer(scene, {}, device_of());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Ray good{{1.2f, -0.2f, 9}, 0, {0, 0, -1}, kInfinity};
  for (const float bad : {nan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Ray origin = good, direction = good;
      origin.origin[axis] = bad;
      direction.direction[axis] = bad;
      for (const Ray& ray : {origin, direction}) {
        try {
          renderer.trace(std::vector<Ray>{good, ray});
          FAIL() << "accepted " << bad;
        } catch (const Error& e) {
          EXPECT_EQ(e.code(), ErrorCode::input);
        }
      }
    }
  }
  Ray still = good;
  still.direction[2] = -0.0f;
  EXPECT_THROW(renderer.trace(std::vector<Ray>{still}), Error);
  EXPECT_NE(renderer.trace(std::vector<Ray>{good})[0].primitive, -1);  // and the renderer still works
}

TEST(Trace, NoRaysAndRepetition) {
  const Scene scene{glass_and_mirror_balls()};
  Renderer renderer(scene, {}, device_of());
  EXPECT_TRUE(renderer.trace({}).empty());
  const std::vector<Ray> rays = random_rays(scene.model(), 77, 1000);
  const std::vector<Hit> once = renderer.trace(rays), often = renderer.trace(rays, false, 3);
  ASSERT_EQ(once.size(), often.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].t, often[i].t);
    ASSERT_EQ(once[i].primitive, often[i].primitive);
  }
  EXPECT_GT(statistics_of(renderer).at("mrays_per_s").get<double>(), 0);
}

TEST(Trace, AnEmptySceneIsMissed) {
  scene::Scene model;
  model.camera = scene::Camera{};
  model.background = {0.25f, 0.5f, 0.75f};
  const Scene scene{std::move(model)};
  Renderer renderer(scene, {}, device_of());
  const Ray ray{{0, 0, 9}, 0, {0, 0, -1}, kInfinity};
  EXPECT_EQ(renderer.trace(std::vector<Ray>{ray})[0].primitive, -1);
  EXPECT_EQ(renderer.trace(std::vector<Ray>{ray}, true)[0].t, kInfinity);
  const Picture picture = renderer.render(exact_options(8, 8));
  EXPECT_FLOAT_EQ(picture.rgb[0], 0.25f);
  EXPECT_FLOAT_EQ(picture.rgb[3 * 63 + 2], 0.75f);
}

}  // namespace
}  // namespace kdray::test
