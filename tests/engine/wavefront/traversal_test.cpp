// A traversal changes time, never a hit: wide, packet, batch and automatic give the binary tree's t,
// primitive, u and v, bit for bit, on every kind of scene and ray that has fooled a kd-tree; whatever rays
// lie beside a ray and however many there are. And the binary tree's nearest hits are those of brute force in
// double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <span>

#include "conformance/samples.h"
#include "kdray/kdray.h"
#include "oracle/build_scene.h"
#include "oracle/primitives.h"
#include "pictures/render.h"
#include "scene/generate/displaced_sphere.h"
#include "support/device.h"
#include "support/scene_fields.h"

namespace kdray {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Walk {
  const char* name;
  Traversal traversal;
};
constexpr Walk kWalks[] = {{"wide", Traversal::wide},
                           {"packet", Traversal::packet},
                           {"batch", Traversal::batch},
                           {"automatic", Traversal::automatic}};
using Walks = std::span<const Walk>;

// ---- Scenes. Coordinates are multiples of 2^-10, so that rays can begin exactly on planes, edges and
// corners.

double snapped(double x) {
  return std::round(x * 1024) / 1024;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine_); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }
  bool coin() { return below(2) == 0; }
  dvec3 point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  dvec3 grid_point(double size) {
    const dvec3 p = point(size);
    return {snapped(p.x), snapped(p.y), snapped(p.z)};
  }
  dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(dvec3(normal(engine_), normal(engine_), normal(engine_)));
  }
  template <class T>
  const T& of(const std::vector<T>& all) {
    return all[static_cast<std::size_t>(below(static_cast<int>(all.size())))];
  }
  template <class T>
  void shuffle(std::vector<T>& all) {
    std::shuffle(all.begin(), all.end(), engine_);
  }

 private:
  std::mt19937 engine_;
};

const scene::Material kAny = oracle::matte(vec3(1));

// n random ones of a kind.
template <class Kind>
void add(Kind, oracle::SceneBuilder& b, test::Draw& draw, int n) {
  b.change([&](scene::Scene& s) {
    const auto material = static_cast<std::uint32_t>(s.materials.size());
    s.materials.push_back(kAny);
    for (int i = 0; i < n; ++i) test::Samples<Kind>::add(s, material, draw);
  });
}

// Points and lengths that are there yet.
void put_on_grid(oracle::SceneBuilder& b) {
  const auto length = [](double& r) {
    if (r > 0) r = std::max(snapped(r), 1.0 / 1024);
  };
  const auto point = [](dvec3& p) { p = {snapped(p.x), snapped(p.y), snapped(p.z)}; };
  b.change([&](scene::Scene& s) { test::change_fields(s, point, length); });
}

// A thousandth as wide as long, most of them along no axis.
void add_needles(oracle::SceneBuilder& b, Random& random, int n) {
  for (int i = 0; i < n; ++i) {
    const dvec3 p = random.grid_point(1), tip = random.grid_point(1);
    b.triangle(p, tip, p + 0.001 * random.direction(), kAny);
  }
}

// n triangles about one corner: no plane parts them there, so the leaf that holds it has nearly all of them.
void add_fan(oracle::SceneBuilder& b, Random& random, int n) {
  const dvec3 corner{0.25, -0.125, 0.5};
  for (int i = 0; i < n; ++i) {
    const dvec3 d = random.direction();
    b.triangle(corner, corner + d, corner + d + 0.05 * random.direction(), kAny);
  }
}

// Squares in the planes x, y, z = -1, 0, 1: geometry, cell walls and split planes coincide.
void add_walls(oracle::SceneBuilder& b) {
  for (int axis = 0; axis < 3; ++axis)
    for (int plane = -1; plane <= 1; ++plane)
      for (int i = 0; i < 16; ++i) {
        dvec3 corner(0), x(0), y(0);
        corner[axis] = plane;
        corner[(axis + 1) % 3] = -1 + 0.5 * (i % 4), corner[(axis + 2) % 3] = -1 + 0.5 * (i / 4);
        x[(axis + 1) % 3] = 0.5, y[(axis + 2) % 3] = 0.5;
        b.quad(corner, x, y, kAny);
      }
}

// ---- Rays.

using test::Place;

std::vector<Place> places_on(const scene::Scene& s, test::Draw& draw) {
  constexpr int kOnEach = 3;
  std::vector<Place> places;
  primitives::for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    for (std::size_t i = 0; i < Kind::of(s).size(); ++i)
      for (int k = 0; k < kOnEach; ++k) places.push_back(test::Samples<Kind>::place(s, i, draw));
  });
  if (places.empty()) places.push_back({dvec3(0), dvec3(1, 0, 0)});
  return places;
}

Ray make_ray(const dvec3& o, const dvec3& d, float t_min = 0, float t_max = kInfinity) {
  const vec3 from(o), along(d);
  return {{from.x, from.y, from.z}, t_min, {along.x, along.y, along.z}, t_max};
}

class RayMaker {
 public:
  RayMaker(const scene::Scene& s, unsigned seed) : random_(seed), of_leaving_(seed + 1) {
    test::Draw draw(seed);
    places_ = places_on(s, draw);
    const DBox box = s.bounds();
    if (s.primitive_count() == 0) return;
    center_ = box.center();
    size_ = 0.5 * std::max({box.extent().x, box.extent().y, box.extent().z});
  }

  // Rays of every sort. The last n_along_surfaces() run along a surface, so that any rounding decides
  // whether they meet it.
  std::vector<Ray> all() {
    add_random(500);
    add_coherent(24);
    add_axis_parallel(400);
    add_in_planes(400);
    add_from_surfaces(400);
    add_at_places(300);
    add_odd_directions(200);
    add_along_surfaces(n_along_surfaces());
    put_leaving_first(304);
    return std::move(rays_);
  }
  static int n_along_surfaces() { return 300; }

 private:
  dvec3 inside() { return center_ + random_.point(size_); }
  float zero() { return random_.coin() ? 0.0f : -0.0f; }

  void add(const dvec3& o, const dvec3& d) {
    if (vec3(d) != vec3(0)) rays_.push_back(make_ray(o, d));
  }
  void add_random(int n) {
    for (int i = 0; i < n; ++i) {
      const dvec3 d = random_.direction() * (random_.coin() ? 1.0 : std::exp(random_.uniform(-5, 5)));
      add(random_.coin() ? inside() : inside() - 3 * size_ * glm::normalize(d), d);
    }
  }
  // A pinhole's, row by row.
  void add_coherent(int n) {
    const dvec3 eye = center_ + size_ * dvec3(0.3, 0.7, 3);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        add(eye, dvec3(-0.1, -0.23, -1) + dvec3(0.8 * (x + 0.5) / n - 0.4, 0.8 * (y + 0.5) / n - 0.4, 0));
  }
  void add_axis_parallel(int n) {
    for (int i = 0; i < n; ++i) {
      Ray r = make_ray(inside(), {zero(), zero(), zero()});
      const int axis = random_.below(3);
      r.direction[axis] = random_.coin() ? 1.0f : -1.0f;
      if (random_.coin()) r.origin[axis] -= 3 * static_cast<float>(size_) * r.direction[axis];
      rays_.push_back(r);
    }
  }
  // One or two coordinates are those of a place on a primitive, where splits are, and do not change along the
  // ray.
  void add_in_planes(int n) {
    for (int i = 0; i < n; ++i) {
      Ray r = make_ray(inside(), random_.direction());
      const vec3 p(random_.of(places_).point);
      const int axis = random_.below(3);
      for (int k = 0; k < 1 + i % 2; ++k) {
        r.origin[(axis + k) % 3] = p[(axis + k) % 3];
        r.direction[(axis + k) % 3] = zero();
      }
      rays_.push_back(r);
    }
  }
  void add_from_surfaces(int n) {
    for (int i = 0; i < n; ++i) add(random_.of(places_).point, random_.direction());
  }
  // From before the place, from the place, and back.
  void add_along_surfaces(int n) {
    for (int i = 0; i < n; ++i) {
      const Place& p = random_.of(places_);
      add(p.point - p.along * (i % 3 == 0 ? 1.0 : 0.0), p.along * (random_.coin() ? 1.0 : -1.0));
    }
  }
  void add_at_places(int n) {
    for (int i = 0; i < n; ++i) {
      const dvec3 o = random_.coin() ? inside() : center_ + 3 * size_ * random_.direction();
      add(o, random_.of(places_).point - o);
    }
  }
  // Very short and very long ones (t stays a float's), and components next to nothing.
  void add_odd_directions(int n) {
    for (int i = 0; i < n; ++i) {
      dvec3 d = random_.direction();
      if (i % 4 == 0) d *= 1e-27;
      if (i % 4 == 1) d *= 1e27;
      if (i % 4 == 2) d[random_.below(3)] *= 1e-20;
      if (i % 4 == 3) d[random_.below(3)] = random_.coin() ? 1e-42 : -1e-38;
      add(inside(), d);
    }
  }

  // From surfaces and beside the scene, eight of nine away from it. What comes first decides whether a walk
  // looks for such rays.
  void put_leaving_first(int n) {
    std::vector<Ray> leaving;
    for (int i = 0; i < n; ++i) {
      const dvec3 out = of_leaving_.direction();
      const dvec3 o = i % 2 ? of_leaving_.of(places_).point : center_ + 2 * size_ * out;
      leaving.push_back(make_ray(o, (i % 9 == 4 ? -1.0 : 1.0) * (out + 0.2 * of_leaving_.direction())));
    }
    rays_.insert(rays_.begin(), leaving.begin(), leaving.end());
  }

  Random random_, of_leaving_;
  std::vector<Place> places_;
  dvec3 center_{0};
  double size_ = 1;
  std::vector<Ray> rays_;
};

// The same rays with intervals that end and begin exactly at, just before and just behind their hits; and odd
// ones.
std::vector<Ray> cut(const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  std::vector<Ray> all;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Ray r = rays[i];
    const float t = std::isfinite(hits[i].t) ? hits[i].t : 1.0f;
    const float before = std::nextafter(t, -kInfinity), behind = std::nextafter(t, kInfinity);
    switch (i % 8) {
      case 0:
        r.t_max = t;
        break;
      case 1:
        r.t_max = behind;
        break;
      case 2:
        r.t_max = before;
        break;
      case 3:
        r.t_min = t;
        break;
      case 4:
        r.t_min = before;
        break;
      case 5:
        r.t_min = -2 * t;
        break;
      case 6:
        r.t_min = 0.5f * t, r.t_max = 3 * t;
        break;
      default:
        r.t_min = behind, r.t_max = t;
        break;  // empty
    }
    all.push_back(r);
  }
  return all;
}

// ---- Comparisons.

bool same_bits(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

std::string in_words(const Hit& h) {
  char text[128];
  std::snprintf(text, sizeof text, "t %a (%.9g) primitive %d u %a v %a", h.t, h.t, h.primitive, h.u, h.v);
  return text;
}
std::string in_words(const Ray& r) {
  char text[256];
  std::snprintf(text, sizeof text, "{{%a, %a, %a}, %a, {%a, %a, %a}, %a}", r.origin[0], r.origin[1],
                r.origin[2], r.t_min, r.direction[0], r.direction[1], r.direction[2], r.t_max);
  return text;
}

// The number of differences and the first of them.
testing::AssertionResult alike(const std::vector<Ray>& rays, const std::vector<Hit>& wanted,
                               const std::vector<Hit>& found) {
  if (wanted.size() != found.size()) return testing::AssertionFailure() << found.size() << " hits";
  std::size_t n = 0, first = 0;
  for (std::size_t i = rays.size(); i-- > 0;)
    if (!same_bits(wanted[i], found[i])) ++n, first = i;
  if (n == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << n << " of " << rays.size() << " hits differ; ray " << first << " "
                                     << in_words(rays[first]) << " wants " << in_words(wanted[first])
                                     << ", found " << in_words(found[first]);
}

struct Subject {
  explicit Subject(const scene::Scene& s, const std::string& device)
      : model(s), scene(scene::Scene(s)), renderer(scene, {}, test::device_of({.device = device})) {}

  std::vector<Hit> trace(const std::vector<Ray>& rays, bool any_hit,
                         Traversal traversal = Traversal::binary) {
    return renderer.trace(rays, any_hit, 1, traversal);
  }

  const scene::Scene& model;
  Scene scene;
  Renderer renderer;
};

// Closest hits and occlusion by every walk are the binary tree's. Returns the closest.
std::vector<Hit> expect_walks_alike(Subject& s, const std::vector<Ray>& rays, const char* which,
                                    Walks walks = kWalks) {
  SCOPED_TRACE(which);
  const std::vector<Hit> closest = s.trace(rays, false), any = s.trace(rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(any[i].t, closest[i].primitive >= 0 ? 0.0f : kInfinity)
        << "ray " << i << " " << in_words(rays[i]);
  for (const Walk& walk : walks) {
    EXPECT_TRUE(alike(rays, closest, s.trace(rays, false, walk.traversal))) << walk.name << ", closest";
    EXPECT_TRUE(alike(rays, any, s.trace(rays, true, walk.traversal))) << walk.name << ", any hit";
  }
  return closest;
}

// A ray's hit does not depend on its neighbours: other orders and numbers of rays.
void expect_neighbours_not_to_matter(Subject& s, const std::vector<Ray>& rays, const std::vector<Hit>& hits,
                                     Walks walks) {
  Random random(5);
  for (const std::size_t n :
       {std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{17}, std::size_t{513}, rays.size()}) {
    SCOPED_TRACE(testing::Message() << n << " rays");
    std::vector<std::size_t> order(rays.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    random.shuffle(order);
    order.resize(std::min(n, rays.size()));
    std::vector<Ray> some;
    std::vector<Hit> wanted;
    for (const std::size_t i : order) some.push_back(rays[i]), wanted.push_back(hits[i]);
    for (const Walk& walk : walks)
      EXPECT_TRUE(alike(some, wanted, s.trace(some, false, walk.traversal))) << walk.name;
  }
}

// What is cut off is not hit: the interval is open at both ends.
void expect_cuts_honoured(const std::vector<Ray>& rays, const std::vector<Hit>& whole,
                          const std::vector<Ray>& cut_rays, const std::vector<Hit>& cut_hits) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit& h = cut_hits[i];
    if (h.primitive >= 0) {
      // Below the normal numbers two distances may round to one.
      ASSERT_TRUE(h.t > cut_rays[i].t_min || (h.t == cut_rays[i].t_min && h.t < 0x1p-126f))
          << "ray " << i << " " << in_words(cut_rays[i]);
      ASSERT_LT(h.t, cut_rays[i].t_max) << "ray " << i << " " << in_words(cut_rays[i]);
    }
    if (whole[i].primitive < 0) continue;
    const std::size_t kind = i % 8;  // of cut()
    if (kind == 0 || kind == 2 || kind == 7) {
      EXPECT_EQ(h.primitive, -1) << "ray " << i << " " << in_words(cut_rays[i]);
    } else if (kind == 1 || kind == 4 || kind == 6) {
      EXPECT_TRUE(same_bits(h, whole[i])) << "ray " << i << " " << in_words(cut_rays[i]);
    }
  }
}

constexpr double kRounding = 2e-6;  // some float steps

// Whether the nearest hit depends on rounding: on a surface that the ray begins on, on where exactly the
// edges and silhouettes are, or on where exactly the ray is. `step`: kRounding of the coordinates in play.
bool hangs_on_rounding(const oracle::World& world, const oracle::Ray& ray, const oracle::Hit& hit,
                       double step) {
  const double speed = glm::length(ray.direction);
  const double t_step = 10 * step / speed;
  // Where the ray grazes a surface, a displacement of that is as many times larger along the ray.
  const double begin = 100 * t_step;
  const auto differs = [&](const oracle::Hit& other) {
    if (other.primitive != hit.primitive) return true;
    return hit.found() && std::abs(other.t - hit.t) > 1e-5 * std::abs(hit.t) + t_step;
  };
  oracle::Ray longer = ray;
  longer.t_min -= begin;
  for (const double grow : {-step, 0.0, step}) {
    if (world.closest(longer, grow).t < ray.t_min + begin) return true;
    if (differs(world.closest(ray, grow))) return true;
  }
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      oracle::Ray moved = ray, turned = ray;
      moved.origin[axis] += sign * step;
      turned.direction[axis] += sign * kRounding * speed;
      if (differs(world.closest(moved)) || differs(world.closest(turned))) return true;
    }
  return false;
}

// The nearest hit is brute force's, unless it hangs on rounding. Returns the share of rays that don't.
double expect_like_brute_force(const scene::Scene& model, const std::vector<Ray>& rays,
                               const std::vector<Hit>& hits) {
  const oracle::World world(model);
  const dvec3 center = model.bounds().center();
  const std::size_t n = rays.size() - static_cast<std::size_t>(RayMaker::n_along_surfaces());
  int certain = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Ray& r = rays[i];
    const oracle::Ray ray{{r.origin[0], r.origin[1], r.origin[2]},
                          {r.direction[0], r.direction[1], r.direction[2]},
                          r.t_min,
                          r.t_max};
    const double speed = glm::length(ray.direction);
    const double step = kRounding * (world.extent() + glm::length(ray.origin - center));
    const oracle::Hit wanted = world.closest(ray);
    if (hangs_on_rounding(world, ray, wanted, step)) continue;
    ++certain;
    EXPECT_EQ(hits[i].primitive >= 0, wanted.found())
        << "ray " << i << " " << in_words(r) << " " << in_words(hits[i]);
    if (!wanted.found() || hits[i].primitive < 0) continue;
    const dvec3 outward = world.surface(ray, wanted).outward;
    const double cosine = std::abs(glm::dot(outward, ray.direction)) / speed;
    EXPECT_LE(std::abs(hits[i].t - wanted.t), 1e-5 * wanted.t + step / (cosine * speed))
        << "ray " << i << " " << in_words(r) << " " << in_words(hits[i]) << " instead of " << wanted.t;
  }
  return certain / static_cast<double>(n);
}

class TraversalTest : public test::EachDevice {
 protected:
  // Everything above; `certain`: the least share of rays whose hit must not hang on rounding.
  void expect_right(const scene::Scene& model, unsigned seed, double certain = 0.3, Walks walks = kWalks) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Subject s(model, GetParam());
    const std::vector<Ray> rays = RayMaker(model, seed).all();
    const std::vector<Hit> hits = expect_walks_alike(s, rays, "whole rays", walks);
    const std::vector<Ray> cut_rays = cut(rays, hits);
    const std::vector<Hit> cut_hits = expect_walks_alike(s, cut_rays, "cut rays", walks);
    expect_neighbours_not_to_matter(s, rays, hits, walks);
    expect_cuts_honoured(rays, hits, cut_rays, cut_hits);
    if (model.primitive_count() == 0) return;
    EXPECT_GE(expect_like_brute_force(model, rays, hits), certain);
  }
};

// Of shapes by the walk that has the code of all others; conformance/TracingOf has each by itself, and
// AllKindsMixed all kinds. (A program is compiled for seconds for each walk and kind.)
TEST_P(TraversalTest, EachKind) {
  primitives::for_each_kind([&](auto kind) {
    SCOPED_TRACE(kind.kNames);
    test::Draw draw(1);
    oracle::SceneBuilder b;
    add(kind, b, draw, kind.kIsShape ? 500 : 700);
    put_on_grid(b);
    expect_right(b.scene(), 2 + kind.kNumber, 0.3, kind.kIsShape ? Walks(kWalks).last(1) : kWalks);
  });
}

// In turn, so that numbers in file order are not indices.
TEST_P(TraversalTest, AllKindsMixed) {
  Random random(7);
  test::Draw draw(7);
  oracle::SceneBuilder b;
  for (int i = 0; i < 100; ++i)
    primitives::for_each_kind(
        [&](auto kind) { add(kind, b, draw, 1 + (i + static_cast<int>(kind.kNumber)) % 3); });
  put_on_grid(b);
  add_needles(b, random, 100);
  expect_right(b.scene(), 8);
}

TEST_P(TraversalTest, OnePrimitive) {
  primitives::for_each_kind([&](auto kind) {
    SCOPED_TRACE(kind.kName);
    test::Draw draw(9);
    oracle::SceneBuilder b;
    add(kind, b, draw, 1);
    expect_right(b.scene(), 9, 0.3, kind.kIsShape ? Walks(kWalks).last(1) : kWalks);
  });
}

TEST_P(TraversalTest, AnEmptySceneHasNoHits) {
  const scene::Scene empty;
  expect_right(empty, 12);
}

// Each primitive four times, the copies far apart in the file: of equal t the smaller number is hit.
TEST_P(TraversalTest, OfCoincidingPrimitivesTheSmallerNumberIsHit) {
  constexpr int kPrimitives = 150;
  oracle::SceneBuilder b;
  for (int copy = 0; copy < 4; ++copy) {
    test::Draw draw(13);
    primitives::for_each_kind([&](auto kind) { add(kind, b, draw, kPrimitives); });
  }
  put_on_grid(b);
  const scene::Scene& model = b.scene();
  Subject s(model, GetParam());
  const std::vector<Ray> rays = RayMaker(model, 14).all();
  const int n = static_cast<int>(primitives::kKinds) * kPrimitives;
  for (const Hit& h : expect_walks_alike(s, rays, "whole rays")) ASSERT_LT(h.primitive, n);
  expect_right(model, 14);
}

// Triangles in one plane that overlap, and squares on planes of each other: ties at every t.
TEST_P(TraversalTest, WallsOnSplitPlanes) {
  Random random(15);
  oracle::SceneBuilder b;
  add_walls(b);
  for (int i = 0; i < 100; ++i) {
    const double x = snapped(random.uniform(-1, 1)), y = snapped(random.uniform(-1, 1));
    b.triangle({x, y, 0}, {x + 0.5, y, 0}, {x, y + 0.25, 0}, kAny);
  }
  expect_right(b.scene(), 16, 0.2);
}

TEST_P(TraversalTest, Needles) {
  Random random(17);
  oracle::SceneBuilder b;
  add_needles(b, random, 600);
  expect_right(b.scene(), 18, 0.2);
}

// Rays side by side, from nowhere near one point, for which packets of a fine mesh end early.
TEST_P(TraversalTest, PacketsThatFareBadly) {
  const scene::Scene model = generate::displaced_sphere_of(100'000);
  Random random(23);
  std::vector<Ray> rays;
  constexpr int kSide = 144;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const dvec3 across(1.3 * (2.0 * x / kSide - 1), 1.3 * (2.0 * y / kSide - 1), 3);
      rays.push_back(make_ray(across, dvec3(0, 0, -1) + 0.02 * random.direction()));
    }
  Subject s(model, GetParam());
  expect_walks_alike(s, rays, "side by side");
}

TEST_P(TraversalTest, AHugeLeaf) {
  Random random(19);
  oracle::SceneBuilder b;
  add_fan(b, random, 2000);
  expect_right(b.scene(), 20, 0.2);
}

scene::Scene moved(scene::Scene s, double scale, const dvec3& offset) {
  test::scale_and_move(s, scale, offset);
  return s;
}

// Far from the origin, huge and tiny. The second seed has a shadow ray of next to no length beside one of
// some length in a huge scene: the frustum from their ends overflows.
TEST_P(TraversalTest, AnyPlaceAndScale) {
  for (const unsigned seed : {21u, 6021u}) {
    test::Draw draw(seed);
    oracle::SceneBuilder b;
    for (int i = 0; i < 50; ++i)
      primitives::for_each_kind([&](auto kind) { add(kind, b, draw, kind.kIsShape ? 1 : 4); });
    put_on_grid(b);
    expect_right(moved(b.scene(), 1, {1e6, -2e6, 3e5}), seed + 1, 0.01);
    expect_right(moved(b.scene(), 1e9, dvec3(0)), seed + 2);
    expect_right(moved(b.scene(), 1e-9, dvec3(0)), seed + 3);
  }
}

KDRAY_FOR_EACH_DEVICE(TraversalTest);

}  // namespace
}  // namespace kdray
