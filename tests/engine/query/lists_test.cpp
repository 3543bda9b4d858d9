// What    Rays of any number of hits: more than a list holds, all at one distance, few beside many; how many
//         are asked for; each hit once, however many leaves a primitive lies in; nothing to hit, no rays, and
//         rays that are none.
#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "engine/query/meshes.h"
#include "engine/query/queried_scene.h"

namespace kdray::test {
namespace {

using query::LocalHits;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Squares of two triangles across z, at z = 0, 1, 2, ...; small ones beside them, so that the tree is deep.
scene::Scene stack(int n, int n_small) {
  std::vector<dvec3> v;
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (int i = 0; i < n; ++i) {
    const auto first = static_cast<std::uint32_t>(v.size());
    for (const dvec3& p : {dvec3(0, 0, i), dvec3(8, 0, i), dvec3(8, 8, i), dvec3(0, 8, i)}) v.push_back(p);
    faces.push_back({first, first + 1, first + 2}), faces.push_back({first, first + 2, first + 3});
  }
  for (int i = 0; i < n_small; ++i) {
    stress::Random random(5, static_cast<std::uint64_t>(i));
    const dvec3 p(random.uniform(0, 8), random.uniform(0, 8), random.uniform(0, n));
    const auto first = static_cast<std::uint32_t>(v.size());
    for (int k = 0; k < 3; ++k) v.push_back(p + 0.05 * random.direction());
    faces.push_back({first, first + 1, first + 2});
  }
  return mesh_of(v, faces);
}

// From the stack's coordinates to those of its own space: all but the centre is a power of two.
struct Own {
  double scale;
  dvec3 center;
  explicit Own(const scene::Scene& s) {
    const LocalSpace space = scene::make_geometry(s).space;
    scale = space.scale, center = space.center;
  }
  Ray upward(double x, double y) const {
    return ray_from(vec3((dvec3(x, y, -5) - center) * scale), vec3(0, 0, static_cast<float>(scale)));
  }
};

class Lists : public OnDevice {};

TEST_F(Lists, HoldMoreThanOnePassFinds) {
  constexpr int kStack = 100;
  const scene::Scene s = stack(kStack, 0);
  QueriedScene queried(s);
  const Own own(s);
  // Inside of a triangle, exactly on the diagonal, at the corner where four triangles of two squares meet no
  // other: each square once or not at all; and beside the stack.
  const std::vector<Ray> rays{own.upward(5.3, 1.7), own.upward(4, 4), own.upward(20, 4), own.upward(1.25, 6)};
  const LocalHits all = queried.all(rays);
  for (const std::size_t i : {0u, 1u, 3u}) {
    ASSERT_EQ(all.splits[i + 1] - all.splits[i], kStack) << i;
    for (std::uint32_t k = 0; k < kStack; ++k) {
      EXPECT_EQ(all.t[all.splits[i] + k], static_cast<float>(5 + k));
      EXPECT_EQ(all.primitive[all.splits[i] + k] / 2, k);
    }
    EXPECT_EQ(all.more[i], 0);
  }
  EXPECT_EQ(all.splits[2], all.splits[3]);
}

TEST_F(Lists, GiveTheFirstSoManyAndSayWhetherThereAreMore) {
  const scene::Scene s = stack(100, 300);
  QueriedScene queried(s);
  const Own own(s);
  std::vector<Ray> rays;
  for (int i = 0; i < 200; ++i) {
    stress::Random random(9, static_cast<std::uint64_t>(i));
    // They end below, in or above the stack.
    Ray r = own.upward(random.uniform(0, 8), random.uniform(0, 8));
    r.t_max = static_cast<float>(random.uniform(0, 110));
    rays.push_back(r);
  }
  const LocalHits all = queried.all(rays);
  EXPECT_GT(all.t.size(), 8000);
  LocalHits some;  // used again each time
  for (const std::uint32_t most : {0u, 1000u, 1u, 2u, 7u, 8u, 9u, 16u, 63u, 64u, 65u, 100u}) {
    SCOPED_TRACE(most);
    query::all_hits(queried.target(), rays, {.max_hits = most}, some);
    const std::vector<std::uint32_t> counts = queried.count(rays, {.max_hits = most});
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::uint64_t n = all.splits[i + 1] - all.splits[i], kept = some.splits[i + 1] - some.splits[i];
      ASSERT_EQ(kept, std::min<std::uint64_t>(n, most)) << i;
      ASSERT_EQ(counts[i], kept) << i;
      ASSERT_EQ(some.more[i] != 0, n > most) << i;
      for (std::uint64_t k = 0; k < kept; ++k) {
        ASSERT_EQ(some.t[some.splits[i] + k], all.t[all.splits[i] + k]);
        ASSERT_EQ(some.primitive[some.splits[i] + k], all.primitive[all.splits[i] + k]);
      }
    }
  }
}

// The same triangle a thousand times; with its corners turned, t differs by a rounding.
TEST_F(Lists, HoldAThousandTrianglesThatCoincide) {
  for (const bool turned : {false, true}) {
    SCOPED_TRACE(turned);
    std::vector<std::array<std::uint32_t, 3>> faces(1000, {0, 1, 2});
    for (std::size_t i = 0; turned && i < faces.size(); ++i)
      std::rotate(faces[i].begin(), faces[i].begin() + i % 3, faces[i].end());
    QueriedScene queried(mesh_of({{-1, -1, 0.1}, {1, -1, 0.3}, {0, 1, -0.2}}, faces));
    const float far = 4 * queried.reach();
    const std::vector<Ray> rays(40, ray_from({0.1f, 0.2f, far}, {0, 0, -1}));
    const LocalHits all = queried.all(rays);
    ASSERT_EQ(all.t.size(), 40 * faces.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      std::vector<std::uint32_t> numbers(all.primitive.begin() + static_cast<long>(all.splits[i]),
                                         all.primitive.begin() + static_cast<long>(all.splits[i + 1]));
      EXPECT_EQ(turned, !std::is_sorted(numbers.begin(), numbers.end()));
      std::sort(numbers.begin(), numbers.end());
      for (std::uint32_t k = 0; k < numbers.size(); ++k) ASSERT_EQ(numbers[k], k);
    }
    EXPECT_TRUE(turned || all.t.front() == all.t.back());
    EXPECT_EQ(queried.count(rays), std::vector<std::uint32_t>(40, 1000));
  }
}

// Large triangles across many leaves.
TEST_F(Lists, HoldAHitOnceHoweverManyLeavesItLiesIn) {
  const scene::Scene s = stack(3, 20000);
  QueriedScene queried(s);
  EXPECT_GT(queried.prepared().tree.references, s.triangles.size() + 500);
  const Own own(s);
  std::vector<Ray> rays;
  for (int i = 0; i < 400; ++i) rays.push_back(own.upward(0.02 * i, 0.013 * i));
  const LocalHits all = queried.all(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto first = all.primitive.begin() + static_cast<long>(all.splits[i]);
    const auto end = all.primitive.begin() + static_cast<long>(all.splits[i + 1]);
    EXPECT_EQ(std::count_if(first, end, [](std::uint32_t n) { return n < 6; }), i == 0 ? end - first : 3)
        << i;
    std::vector<std::uint32_t> numbers(first, end);
    std::sort(numbers.begin(), numbers.end());
    EXPECT_EQ(std::adjacent_find(numbers.begin(), numbers.end()), numbers.end()) << i;
  }
}

TEST_F(Lists, AreEmptyWhereThereIsNothing) {
  QueriedScene nothing(mesh_of({}, {}));
  const std::vector<Ray> rays(100, ray_from({0, 0, 0}, {1, 2, 3}));
  EXPECT_TRUE(nothing.all(rays).t.empty());
  EXPECT_EQ(nothing.count(rays), std::vector<std::uint32_t>(100, 0));
  QueriedScene cube(stress::cube());
  EXPECT_TRUE(cube.count({}).empty());
  const LocalHits none = cube.all({});
  EXPECT_EQ(none.splits.size(), 1);
  EXPECT_EQ(none.splits[0], 0);
}

TEST_F(Lists, RefuseRaysThatAreNoneOrLetThemMiss) {
  QueriedScene cube(stress::cube());
  const float nan = std::nanf("");
  const Ray good = ray_from({0, 0, 0}, {1, 2, 3});
  for (int field = 0; field < 9; ++field) {
    std::vector<Ray> rays(70, good);
    Ray& bad = rays[50];
    if (field < 3) bad.origin[field] = field == 1 ? kInfinity : nan;
    if (field >= 3 && field < 6) bad.direction[field - 3] = field == 4 ? -kInfinity : nan;
    if (field == 6) bad.t_min = nan;
    if (field == 7) bad.t_max = nan;
    if (field == 8) bad = ray_from({0, 0, 0}, {0, -0.0f, 0});
    for (const bool counts : {false, true}) try {
        counts ? static_cast<void>(cube.count(rays)) : static_cast<void>(cube.all(rays));
        FAIL() << field;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input);
        EXPECT_EQ(std::string(error.what()).rfind("ray 50: ", 0), 0) << error.what();
      }
    for (const Traversal walk : {Traversal::wide, Traversal::packet, Traversal::batch}) {
      std::vector<std::uint32_t> expected(70, 1);
      expected[50] = 0;
      EXPECT_EQ(cube.count(rays, {.traversal = walk, .faulty_miss = true}), expected) << field;
    }
  }
  EXPECT_THROW(cube.count({&good, 1}, {.traversal = Traversal::binary}), Error);
}

}  // namespace
}  // namespace kdray::test
