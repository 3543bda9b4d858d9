// Closest and any hits in scenes with instances: against copies in double, the same bits by every walk and
// with every form of vectors, and of equal hits the one that comes first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>

#include "engine/query/all_hits.h"
#include "engine/query/device_scene.h"
#include "engine/query/instance_judge.h"
#include "engine/query/meshes.h"
#include "engine/query/trace.h"
#include "scene/model/instances.h"
#include "support/device.h"
#include "support/variable.h"

namespace kdray::test {
namespace {

using scene::rotation, scene::scaling, scene::translation;

constexpr unsigned kSeed = 28;
constexpr Traversal kWalks[] = {Traversal::automatic, Traversal::wide, Traversal::packet, Traversal::batch};

class Random {
 public:
  explicit Random(unsigned seed) : bits_(seed) {}
  double in(double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(bits_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(bits_); }
  dvec3 vector(double size) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  dvec3 direction() {
    for (;;)
      if (const dvec3 v = vector(1); glm::length(v) > 0.1 && glm::length(v) < 1) return glm::normalize(v);
  }

 private:
  std::mt19937 bits_;
};

// ---- Scenes

std::uint32_t add_mesh(scene::Scene& s, scene::Scene mesh) {
  mesh.materials.clear();
  s.meshes.push_back(std::make_shared<const scene::Scene>(std::move(mesh)));
  return static_cast<std::uint32_t>(s.meshes.size() - 1);
}
void add(scene::Scene& s, std::uint32_t mesh, const dmat4& to_world) {
  s.instances.push_back(scene::instance_of(to_world, mesh));
  ASSERT_EQ(scene::fault_of(s.instances.back()), nullptr);
}
scene::Scene empty_scene() {
  scene::Scene s;
  s.name = "instances";
  s.materials.emplace_back();
  return s;
}
scene::Scene with_ground(double height) {
  scene::Scene s =
      mesh_of({{-9, height, -9}, {9, height, -9}, {9, height, 9}, {-9, height, 9}}, {{0, 1, 2}, {0, 2, 3}});
  s.name = "ground";
  return s;
}
scene::Scene balls(Random& random, int n) {
  scene::Scene s = empty_scene();
  for (int i = 0; i < n; ++i)
    s.spheres.push_back(
        {.center = random.vector(1), .radius = random.in(0.1, 0.5), .number = static_cast<std::uint32_t>(i)});
  return s;
}

dmat4 anywhere(Random& random, const dvec3& scale, double spread) {
  return translation(random.vector(spread)) * rotation(random.direction(), random.in(0, 6)) * scaling(scale) *
         rotation(random.direction(), random.in(0, 6));
}

scene::Scene turned_and_scaled(Random& random) {
  scene::Scene s = with_ground(-2);
  const std::uint32_t meshes[] = {add_mesh(s, torus(12, 8)), add_mesh(s, icosphere(2)),
                                  add_mesh(s, cubes(5, 3))};
  for (int i = 0; i < 40; ++i) add(s, meshes[i % 3], anywhere(random, dvec3(std::exp2(random.in(-5, 0))), 3));
  return s;
}

scene::Scene mirrored_and_stretched(Random& random) {
  scene::Scene s = empty_scene();
  const std::uint32_t meshes[] = {add_mesh(s, torus(12, 8)), add_mesh(s, balls(random, 9))};
  for (std::uint32_t i = 0; i < 30;) {
    const dvec3 scale = {std::exp2(random.in(-2, 1)), std::exp2(random.in(-2, 1)),
                         -std::exp2(random.in(-2, 1))};
    const scene::Instance instance = scene::instance_of(anywhere(random, scale, 3), meshes[i % 2]);
    if (scene::fault_of(instance) != nullptr) continue;
    s.instances.push_back(instance);
    ++i;
  }
  return s;
}

scene::Scene one_alone(Random& random) {
  scene::Scene s = empty_scene();
  add(s, add_mesh(s, icosphere(3)), anywhere(random, dvec3(0.7), 0.1));
  return s;
}

// Far from the origin, where instances keep the bits that the scene's own floats would lose.
scene::Scene far_away(Random& random) {
  scene::Scene s = empty_scene();
  const std::uint32_t mesh = add_mesh(s, torus(12, 8));
  for (int i = 0; i < 12; ++i)
    add(s, mesh, translation({1000, -2000, 500}) * anywhere(random, dvec3(0.4), 2));
  return s;
}

// Meshes that nothing can be hit of, before and between others: they count where instances are numbered.
scene::Scene among_empty_ones(Random& random) {
  scene::Scene s = empty_scene();
  const std::uint32_t none = add_mesh(s, empty_scene()), mesh = add_mesh(s, icosphere(2)),
                      flat = add_mesh(s, mesh_of({{0, 0, 0}, {1, 1, 1}}, {{0, 1, 1}}));
  for (int i = 0; i < 9; ++i) {
    add(s, none, dmat4(1));
    add(s, mesh, anywhere(random, dvec3(0.5), 2));
    add(s, flat, dmat4(1));
  }
  return s;
}

// Of meshes large enough, and so close together, that instances are opened (flatten/instance_openings.h).
scene::Scene close_together(Random& random) {
  scene::Scene s = with_ground(-1);
  const std::uint32_t meshes[] = {add_mesh(s, icosphere(4)), add_mesh(s, torus(48, 40))};
  for (std::uint32_t i = 0; i < 7; ++i)
    add(s, meshes[i % 2], anywhere(random, {random.in(0.5, 1), 0.8, i % 3 == 0 ? -0.7 : 0.7}, 0.5));
  return s;
}
bool are_opened(DeviceScene& scene) {
  return scene.prepared().flat.instances.size() > scene.prepared().counts.instances;
}

// ---- Rays

// Sixteen of a kind and single ones, from outside and inside; along axes, and to corners and centres.
std::vector<Ray> rays_about(const scene::Scene& s, Random& random, std::size_t n) {
  const DBox box = s.bounds();
  const dvec3 middle = (box.lo + box.hi) * 0.5, half = (box.hi - box.lo) * 0.5;
  std::vector<Ray> rays;
  while (rays.size() < n) {
    const scene::Instance& at = s.instances[random.below(s.instances.size())];
    const scene::Scene& mesh = *s.meshes[at.mesh];
    dvec3 to = middle + random.vector(1) * half;
    if (!mesh.vertices.empty() && random.in(0, 1) < 0.5)
      to = at.point(mesh.vertices[random.below(mesh.vertices.size())]);
    if (random.in(0, 1) < 0.2) to = at.move;
    const dvec3 from = random.in(0, 1) < 0.7 ? middle + random.direction() * (1.5 * glm::length(half))
                                             : middle + random.vector(1) * half;
    const std::size_t alike = random.below(3) ? 1 : 16;
    const bool limited = random.below(4) == 0;
    const std::size_t axis = random.below(12);
    for (std::size_t k = 0; k < alike; ++k) {
      const dvec3 o = from + random.vector(0.01);
      dvec3 d = to - from + random.vector(1e-3);
      if (axis < 6) d = dvec3(0), d[static_cast<int>(axis % 3)] = axis < 3 ? 1 : -1;
      if (!(glm::length(d) > 0)) continue;
      const dvec3 start = axis < 6 ? to - d * 3.0 * glm::length(half) : o;
      Ray ray{{}, limited ? 0.3f : 0.0f, {}, limited ? 0.9f : std::numeric_limits<float>::infinity()};
      for (int c = 0; c < 3; ++c)
        ray.origin[c] = static_cast<float>(start[c]), ray.direction[c] = static_cast<float>(d[c]);
      rays.push_back(ray);
    }
  }
  return rays;
}

bool same(const query::Traced& a, const query::Traced& b) {
  return a.hits.size() == b.hits.size() && a.instances == b.instances &&
         std::memcmp(a.hits.data(), b.hits.data(), a.hits.size() * sizeof(Hit)) == 0;
}

class InstanceQueries : public EachDevice {
 protected:
  query::Traced traced(DeviceScene& scene, std::span<const Ray> rays, Traversal walk, bool any_hit = false) {
    return query::trace(scene.target(walk), rays, {.any_hit = any_hit});
  }
  void expect_right(const scene::Scene& s, unsigned seed);
  void expect_same_with_every_form(const scene::Scene& s);
};
KDRAY_FOR_EACH_DEVICE(InstanceQueries);

void InstanceQueries::expect_right(const scene::Scene& s, unsigned seed) {
  Random random(seed);
  const std::vector<Ray> rays = rays_about(s, random, 4000);
  DeviceScene queried(s, GetParam());
  const query::Traced first = traced(queried, rays, Traversal::wide);
  const InstanceJudge judge(s);
  std::size_t n_hits = 0, n_in_instances = 0, n_wrong = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    n_hits += first.hits[i].primitive >= 0;
    n_in_instances += first.instances[i] != scene::kNone;
    const std::string wrong = judge.wrong(rays[i], first.hits[i], first.instances[i]);
    if (!wrong.empty() && ++n_wrong < 5) ADD_FAILURE() << "seed " << seed << ", ray " << i << ": " << wrong;
  }
  EXPECT_EQ(n_wrong, 0u) << "of " << rays.size();
  EXPECT_GT(n_hits, rays.size() / 5);
  EXPECT_GT(n_in_instances, rays.size() / 10);
  for (const Traversal walk : kWalks) {
    EXPECT_TRUE(same(first, traced(queried, rays, walk))) << "walk " << static_cast<int>(walk);
    const query::Traced any = traced(queried, rays, walk, true);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(any.hits[i].t == 0, first.hits[i].primitive >= 0) << "ray " << i << " of seed " << seed;
  }
}

// ---- All hits

std::vector<InstanceJudge::Crossing> crossings_of(const query::LocalHits& all, std::size_t ray) {
  std::vector<InstanceJudge::Crossing> of_ray;
  for (std::size_t k = all.splits[ray]; k < all.splits[ray + 1]; ++k)
    of_ray.push_back({all.t[k], all.instance[k], all.primitive[k]});
  return of_ray;
}

// A ray from outside of everything to its outside crosses each instance of a closed mesh an even number of
// times.
bool crosses_evenly(const std::vector<InstanceJudge::Crossing>& crossings) {
  std::map<std::uint32_t, int> n;
  for (const auto& c : crossings)
    if (c.instance != scene::kNone) ++n[c.instance];
  return std::ranges::all_of(n, [](const auto& of_instance) { return of_instance.second % 2 == 0; });
}

class AllHitsOfInstances : public InstanceQueries {
 protected:
  void expect_right(const scene::Scene& s, unsigned seed, bool closed);
};
KDRAY_FOR_EACH_DEVICE(AllHitsOfInstances);

void AllHitsOfInstances::expect_right(const scene::Scene& s, unsigned seed, bool closed) {
  Random random(seed);
  const std::vector<Ray> rays = rays_about(s, random, 3000);
  DeviceScene queried(s, GetParam());
  const query::LocalHits all = query::all_hits(queried.target(), rays);
  ASSERT_EQ(all.instance.size(), all.t.size());
  const query::Traced closest = traced(queried, rays, Traversal::wide);
  const InstanceJudge judge(s);
  const DBox box = s.bounds();
  std::size_t n_wrong = 0, n_through = 0, first = 0, n_hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto crossings = crossings_of(all, i);
    const std::string wrong = judge.wrong(rays[i], crossings);
    if (!wrong.empty() && ++n_wrong < 5) ADD_FAILURE() << "seed " << seed << ", ray " << i << ": " << wrong;
    const dvec3 o(rays[i].origin[0], rays[i].origin[1], rays[i].origin[2]);
    const bool outside =
        glm::any(glm::lessThan(o, box.lo - 1e-3)) || glm::any(glm::greaterThan(o, box.hi + 1e-3));
    if (closed && outside && rays[i].t_min == 0 && std::isinf(rays[i].t_max)) {
      ++n_through;
      EXPECT_TRUE(crosses_evenly(crossings)) << "seed " << seed << ", ray " << i;
    }
    if (closest.hits[i].primitive < 0 || crossings.empty()) continue;
    ++n_hits;
    first += crossings[0].t == closest.hits[i].t && crossings[0].instance == closest.instances[i] &&
             crossings[0].primitive == static_cast<std::uint32_t>(closest.hits[i].primitive);
  }
  EXPECT_EQ(n_wrong, 0u);
  if (closed) {
    EXPECT_GT(n_through, rays.size() / 4);
  }
  EXPECT_GE(first, n_hits * 99 / 100) << "of " << n_hits << " the closest hit comes first";
  const std::vector<std::uint32_t> counts = query::count_hits(queried.target(), rays);
  const query::LocalHits three = query::all_hits(queried.target(), rays, {.max_hits = 3});
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(counts[i], all.splits[i + 1] - all.splits[i]) << i;
    const auto whole = crossings_of(all, i), some = crossings_of(three, i);
    ASSERT_EQ(some.size(), std::min<std::size_t>(3, whole.size())) << i;
    for (std::size_t k = 0; k < some.size(); ++k)
      ASSERT_TRUE(some[k].t == whole[k].t && some[k].instance == whole[k].instance) << i;
  }
}

TEST_P(AllHitsOfInstances, TurnedAndScaled) {
  for (unsigned seed = kSeed; seed < kSeed + 2; ++seed) {
    Random random(seed);
    expect_right(turned_and_scaled(random), seed, true);
  }
}
TEST_P(AllHitsOfInstances, MirroredAndStretched) {
  Random random(kSeed);
  expect_right(mirrored_and_stretched(random), kSeed, true);
}
TEST_P(AllHitsOfInstances, AmongEmptyOnesAndFarAway) {
  Random random(kSeed);
  expect_right(among_empty_ones(random), kSeed, true);
  expect_right(far_away(random), kSeed, true);
}

TEST_P(AllHitsOfInstances, CloseTogether) {
  Random random(kSeed);
  expect_right(close_together(random), kSeed, true);
}

// A hundred in one place, whose hits of one t go over several passes, in the order of instances.
TEST_P(AllHitsOfInstances, OfOneTComeInTheOrderOfInstances) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  const std::uint32_t mesh = add_mesh(s, icosphere(1));
  const dmat4 place = anywhere(random, {0.7, 0.9, -1.1}, 0.5);
  for (int i = 0; i < 100; ++i) add(s, mesh, place);
  DeviceScene queried(s, GetParam());
  const std::vector<Ray> rays = rays_about(s, random, 400);
  const query::LocalHits all = query::all_hits(queried.target(), rays);
  std::size_t n_many = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto crossings = crossings_of(all, i);
    ASSERT_EQ(crossings.size() % 100, 0u) << i;
    n_many += crossings.size() >= 200;
    for (std::size_t k = 0; k < crossings.size(); ++k) ASSERT_EQ(crossings[k].instance, k % 100) << i;
  }
  EXPECT_GT(n_many, rays.size() / 4);
}

TEST_P(InstanceQueries, TurnedAndScaled) {
  for (unsigned seed = kSeed; seed < kSeed + 3; ++seed) {
    Random random(seed);
    expect_right(turned_and_scaled(random), seed);
  }
}
TEST_P(InstanceQueries, MirroredAndStretched) {
  for (unsigned seed = kSeed; seed < kSeed + 3; ++seed) {
    Random random(seed);
    expect_right(mirrored_and_stretched(random), seed);
  }
}
TEST_P(InstanceQueries, CloseTogether) {
  for (unsigned seed = kSeed; seed < kSeed + 2; ++seed) {
    Random random(seed);
    const scene::Scene s = close_together(random);
    DeviceScene queried(s, GetParam());
    EXPECT_TRUE(are_opened(queried));
    expect_right(s, seed);
  }
}
TEST_P(InstanceQueries, OneAlone) {
  Random random(kSeed);
  expect_right(one_alone(random), kSeed);
}
TEST_P(InstanceQueries, FarAway) {
  Random random(kSeed);
  expect_right(far_away(random), kSeed);
}
TEST_P(InstanceQueries, AmongEmptyOnes) {
  Random random(kSeed);
  expect_right(among_empty_ones(random), kSeed);
}

// Triangles and spheres, by packets and batches, which the automatic walk has both.
void InstanceQueries::expect_same_with_every_form(const scene::Scene& s) {
  Random random(kSeed);
  const std::vector<Ray> rays = rays_about(s, random, 6000);
  DeviceScene best(s, GetParam());
  const query::Traced first = traced(best, rays, Traversal::automatic);
  for (const char* const form : {"portable", "avx2"}) {
    const Variable asked_for("KDRAY_SIMD", form);
    std::unique_ptr<DeviceScene> queried;
    try {
      queried = std::make_unique<DeviceScene>(s, GetParam());
    } catch (const Error&) {
      continue;  // this device can't have it
    }
    EXPECT_TRUE(same(first, traced(*queried, rays, Traversal::automatic))) << form;
  }
}

TEST_P(InstanceQueries, AreTheSameBitsWithEveryFormOfVectors) {
  Random random(kSeed);
  expect_same_with_every_form(mirrored_and_stretched(random));
  expect_same_with_every_form(close_together(random));
}

// The judge itself: what is told of another ray, or of another instance, or a little farther off, is wrong.
TEST_P(InstanceQueries, AreJudgedStrictly) {
  Random random(kSeed);
  const scene::Scene s = turned_and_scaled(random);
  const std::vector<Ray> rays = rays_about(s, random, 2000);
  DeviceScene queried(s, GetParam());
  const query::Traced all = traced(queried, rays, Traversal::wide);
  const InstanceJudge judge(s);
  int n = 0, moved = 0, swapped = 0, lost = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t instance = all.instances[i];
    if (all.hits[i].primitive < 0 || instance == scene::kNone) continue;
    ++n;
    Hit farther = all.hits[i];
    farther.t *= 1.02f;
    moved += !judge.wrong(rays[i], farther, instance).empty();
    swapped += !judge.wrong(rays[i], all.hits[i], instance ^ 1).empty();
    lost += !judge.wrong(rays[i], {std::numeric_limits<float>::infinity(), -1, 0, 0}, scene::kNone).empty();
  }
  ASSERT_GT(n, 300);
  EXPECT_GT(moved, n * 9 / 10);
  EXPECT_GT(swapped, n * 9 / 10);
  EXPECT_GT(lost, n * 8 / 10);
}

// Copies in one place, in any order and beside the scene's own: the scene's goes first, then the first one.
TEST_P(InstanceQueries, OfEqualHitsTheFirstIsTold) {
  Random random(kSeed);
  scene::Scene s = empty_scene();
  const std::uint32_t twin = add_mesh(s, doubled()), ball = add_mesh(s, icosphere(2));
  const dmat4 place = anywhere(random, {0.7, 0.9, -1.1}, 0.5);
  for (const std::uint32_t mesh : {twin, ball, twin, ball, ball, twin}) add(s, mesh, place);
  DeviceScene queried(s, GetParam());
  const std::vector<Ray> rays = rays_about(s, random, 3000);
  for (const Traversal walk : kWalks) {
    const query::Traced all = traced(queried, rays, walk);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (all.hits[i].primitive < 0) continue;
      ASSERT_LT(all.instances[i], 2u) << i;
      // The tetrahedron that is there twice: of its two faces in one place the smaller number.
      if (all.instances[i] == 0) {
        ASSERT_LT(all.hits[i].primitive, 4) << i;
      }
    }
  }
  // A floor of the scene's own in one plane with an instance's, exactly.
  scene::Scene floors = with_ground(-2);
  scene::Scene mesh = with_ground(-2);
  add(floors, add_mesh(floors, std::move(mesh)), dmat4(1));
  DeviceScene of_floors(floors, GetParam());
  std::vector<Ray> down;
  for (int i = 0; i < 500; ++i) {
    const dvec3 o = random.vector(4);
    down.push_back({{float(o.x), 5, float(o.z)}, 0, {0, -1, 0}, 1e9f});
  }
  for (const Traversal walk : kWalks) {
    const query::Traced hits = traced(of_floors, down, walk);
    for (const std::uint32_t instance : hits.instances) ASSERT_EQ(instance, scene::kNone);
  }
}

TEST_P(InstanceQueries, ScenesWithoutInstancesTellNone) {
  DeviceScene queried(icosphere(2), GetParam());
  const Ray ray{{0, 0, 5}, 0, {0, 0, -1}, 100};
  EXPECT_TRUE(traced(queried, std::span(&ray, 1), Traversal::automatic).instances.empty());
}

}  // namespace
}  // namespace kdray::test
