// What    All hits are the same bits by every walk, and hold the closest hit: in closed meshes and in scenes
//         of every kind.
#include <algorithm>
#include <cstring>

#include "conformance/all_kinds.h"
#include "engine/query/meshes.h"
#include "engine/query/queried_scene.h"
#include "engine/query/trace.h"

namespace kdray::test {
namespace {

using query::LocalHits;

constexpr std::uint64_t kSeed = 31;
constexpr Traversal kWalks[] = {Traversal::wide, Traversal::packet, Traversal::batch, Traversal::automatic};

std::vector<Ray> rays_about(const QueriedScene& scene, std::size_t n) {
  std::vector<Ray> rays;
  const float reach = scene.reach();
  for (std::size_t i = 0; rays.size() < n; ++i) {
    stress::Random random(kSeed, i);
    const dvec3 o = random.direction() * (2.0 * reach);
    const dvec3 at(random.uniform(-reach, reach), random.uniform(-reach, reach),
                   random.uniform(-reach, reach));
    // Some alone, some sixteen of a kind, for packets.
    const int alike = random.below(2) ? 16 : 1;
    for (int k = 0; k < alike; ++k) {
      const dvec3 aside(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      rays.push_back(ray_from(vec3(o), vec3(at + 0.01 * reach * aside - o), random.below(4) ? 0 : 0.5f,
                              random.below(4) ? std::numeric_limits<float>::infinity() : 1.2f));
    }
  }
  return rays;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

bool same(const LocalHits& a, const LocalHits& b) {
  return same_bits(a.splits, b.splits) && same_bits(a.t, b.t) && same_bits(a.primitive, b.primitive) &&
         same_bits(a.u, b.u) && same_bits(a.v, b.v) && same_bits(a.more, b.more);
}

void expect_one_answer(QueriedScene& queried) {
  const std::vector<Ray> rays = rays_about(queried, 3000);
  for (const std::uint32_t max_hits : {0xffffffffu, 3u}) {
    const LocalHits all = queried.all(rays, {.max_hits = max_hits, .traversal = Traversal::wide});
    EXPECT_GT(all.t.size(), 500);
    for (const Traversal walk : kWalks) {
      const query::CollectOptions options{.max_hits = max_hits, .traversal = walk};
      EXPECT_TRUE(same(all, queried.all(rays, options))) << "walk " << static_cast<int>(walk);
      const std::vector<std::uint32_t> counts = queried.count(rays, options);
      for (std::size_t i = 0; i < rays.size(); ++i)
        ASSERT_EQ(counts[i], all.splits[i + 1] - all.splits[i]) << in_words(rays[i]);
    }
  }
}

// Where no edge, rim or tangent is in play the first of all hits is the closest one, bit for bit.
void expect_closest_first(QueriedScene& queried, double share) {
  const std::vector<Ray> rays = rays_about(queried, 3000);
  const LocalHits all = queried.all(rays);
  const std::vector<Hit> closest = query::trace(queried.target(), rays, {}).hits;
  std::size_t n = 0, first = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (closest[i].primitive < 0) {
      EXPECT_EQ(all.splits[i], all.splits[i + 1]) << in_words(rays[i]);
      continue;
    }
    const std::size_t k = all.splits[i];
    ++n;
    first += k < all.splits[i + 1] && all.t[k] == closest[i].t &&
             all.primitive[k] == static_cast<std::uint32_t>(closest[i].primitive) &&
             all.u[k] == closest[i].u && all.v[k] == closest[i].v;
  }
  EXPECT_GT(n, 300);
  EXPECT_GE(static_cast<double>(first), share * static_cast<double>(n));
}

class Walks : public OnDevice {};

TEST_F(Walks, FindTheSameInMeshes) {
  for (const NamedMesh& m :
       {NamedMesh{"torus", torus(24, 12)}, {"cubes", cubes(3, 6)}, {"fine", icosphere(4)}}) {
    SCOPED_TRACE(m.name);
    QueriedScene queried(m.scene);
    EXPECT_EQ(queried.prepared().wide.block, 4);
    expect_one_answer(queried);
    expect_closest_first(queried, 0.999);
  }
}

TEST_F(Walks, FindTheSameInBlocksOfEight) {
  const scene::Scene fine = icosphere(4);
  QueriedScene eights(fine, Space::own, Blocks::of_eight), fours(fine);
  ASSERT_EQ(eights.prepared().wide.block, 8);
  expect_one_answer(eights);
  const std::vector<Ray> rays = rays_about(eights, 3000);
  EXPECT_TRUE(same(eights.all(rays), fours.all(rays)));
}

TEST_F(Walks, FindTheSameOfAllKinds) {
  QueriedScene queried(mixed_scene(100, kSeed));
  expect_one_answer(queried);
  expect_closest_first(queried, 1);
}

}  // namespace
}  // namespace kdray::test
