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

// Eye rays of a picture, sixteen of a square after the other: packets that share their way into the tree.
std::vector<Ray> eye_rays(const dvec3& eye, const dvec3& at, double width, float t_min = 0) {
  constexpr int kSide = 64, kSquare = 4;
  const dvec3 ahead = glm::normalize(at - eye), right = glm::normalize(glm::cross(ahead, dvec3(0.1, 1, 0.2))),
              up = glm::cross(right, ahead);
  std::vector<Ray> rays;
  for (int i = 0; i < kSide * kSide; ++i) {
    const int square = i / (kSquare * kSquare), of_row = kSide / kSquare;
    const double x = square % of_row * kSquare + i % kSquare,
                 y = square / of_row * kSquare + i / kSquare % kSquare;
    const dvec3 d = ahead + width * ((x / kSide - 0.5) * right + (y / kSide - 0.5) * up);
    rays.push_back(ray_from(vec3(eye), vec3(d), t_min, std::numeric_limits<float>::infinity()));
  }
  return rays;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
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

TEST_F(Walks, FindTheSameWherePacketsShareTheirWay) {
  for (const scene::Scene& scene : {torus(24, 12), cubes(3, 6), icosphere(5), mixed_scene(400, kSeed)}) {
    QueriedScene queried(scene);
    const double reach = queried.reach();
    std::size_t n_hits = 0;
    for (const double away : {0.05, 0.7, 2.5, 40.0})
      for (const double width : {0.02, 0.3}) {
        const std::vector<Ray> rays =
            eye_rays(dvec3(0.9, 0.3, -0.4) * (away * reach), dvec3(-0.3, 0.1, 0.2) * reach, width);
        query::Target target = queried.target();
        target.traversal = Traversal::wide;
        const std::vector<Hit> one_by_one = query::trace(target, rays, {}).hits;
        target.traversal = Traversal::packet;
        EXPECT_TRUE(same_bits(query::trace(target, rays, {}).hits, one_by_one)) << away << " " << width;
        const LocalHits all = queried.all(rays, {.traversal = Traversal::packet});
        EXPECT_TRUE(same(all, queried.all(rays, {.traversal = Traversal::wide}))) << away << " " << width;
        n_hits += all.t.size();
      }
    EXPECT_GT(n_hits, 3000);
  }
}

// A t_min just below 0 lets in what rays begin at, and packets are bounded all the same.
TEST_F(Walks, FindTheSameWhereRaysBeginAtASurface) {
  QueriedScene queried(stress::cube(), Space::worlds);
  std::size_t n_at_start = 0;
  for (const vec3 eye : {vec3(0.25f, 0.5f, 1), vec3(-1, 0.3f, 0), vec3(1, 1, 1), vec3(0, -1, 1)})
    for (const float t_min : {-1e-30f, -1e-14f, -1e-8f, -0.5f, 1e-30f})
      for (const double sign : {-1.0, 1.0}) {
        const std::vector<Ray> rays =
            eye_rays(dvec3(eye), dvec3(eye) * (1 + sign) + dvec3(0.1, 0.2, 0.3), 0.2, t_min);
        query::Target target = queried.target();
        target.traversal = Traversal::wide;
        const std::vector<Hit> one_by_one = query::trace(target, rays, {}).hits;
        target.traversal = Traversal::packet;
        EXPECT_TRUE(same_bits(query::trace(target, rays, {}).hits, one_by_one)) << t_min;
        const LocalHits all = queried.all(rays, {.traversal = Traversal::packet});
        EXPECT_TRUE(same(all, queried.all(rays, {.traversal = Traversal::wide}))) << t_min;
        if (t_min < 0 && t_min >= -1e-8f)
          n_at_start += static_cast<std::size_t>(std::ranges::count_if(
              one_by_one, [](const Hit& hit) { return hit.primitive >= 0 && hit.t == 0; }));
      }
  EXPECT_GT(n_at_start, 50000);
}

}  // namespace
}  // namespace kdray::test
