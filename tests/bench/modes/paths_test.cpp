// What    The ways of rays through the subtrees of a real tree: from near to far, to where the ray ends, and
//         their costs don't depend on the cut. Random rays have seed 5.
#include "bench/modes/paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "accel/prepare/prepared.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/generate/random.h"

namespace kdray::bench {
namespace {

const prepare::Prepared& ball() {
  static const prepare::Prepared kBall = prepare::prepare(generate::displaced_sphere_of(5000), TreeOptions{});
  return kBall;
}

std::vector<LifeRay> random_lives(std::size_t n) {
  generate::Random random(5);
  std::vector<LifeRay> lives(n);
  for (LifeRay& life : lives) {
    const dvec3 origin = random.in_box(dvec3(-1.5), dvec3(1.5)), direction = random.direction();
    for (int k = 0; k < 3; ++k) {
      life.ray.origin[k] = static_cast<float>(origin[k]);
      life.ray.direction[k] = static_cast<float>(direction[k]);
    }
    life.ray.t_max = std::numeric_limits<float>::infinity();
  }
  return lives;
}

odprt::Cut cut_ball(std::size_t n) {
  return odprt::cut(ball().flat, ball().wide, n);
}

// Every subtree an owner of its own.
Paths paths_of(const odprt::Cut& cut, std::span<const LifeRay> lives) {
  std::vector<std::uint32_t> itself(cut.subtrees.size());
  std::iota(itself.begin(), itself.end(), 0u);
  return find_paths(ball().wide, cut, itself, lives, ball().geometry.space);
}

double sum_of(const Paths& paths) {
  double sum = 0;
  for (const Visit& v : paths.visits) sum += v.cost;
  return sum;
}

TEST(PathsOfRays, CostTheSameWhateverTheCut) {
  const std::vector<LifeRay> lives = random_lives(500);
  const double whole = sum_of(paths_of(cut_ball(1), lives));
  EXPECT_GT(whole, 500);  // each visits the root at least
  for (const std::size_t n : {2u, 30u, 1000u}) {
    const odprt::Cut cut = cut_ball(n);
    EXPECT_NEAR(sum_of(paths_of(cut, lives)), whole, 1e-6 * whole);
  }
}

// The subtrees' bounds that a line from the outside passes, sorted by where it enters them, are the path.
TEST(PathsOfRays, GoFromNearToFar) {
  const odprt::Cut cut = cut_ball(40);
  for (const LifeRay& life : random_lives(300)) {
    const Paths paths = paths_of(cut, std::span(&life, 1));
    double before = -std::numeric_limits<double>::infinity();
    const dvec3 from =
        ball().geometry.space.local({life.ray.origin[0], life.ray.origin[1], life.ray.origin[2]});
    for (const Visit& v : paths.of(0)) {
      if (v.owner == kDirectory) continue;
      const Box& box = cut.subtrees[v.owner].bounds;
      double enter = 0, leave = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        const double origin = from[k], along = life.ray.direction[k];
        const double a = (box.lo[k] - origin) / along, b = (box.hi[k] - origin) / along;
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      EXPECT_LE(enter, leave * (1 + 1e-6));
      EXPECT_GE(enter,
                before - 1e-5 * kLocalReach);  // cells are disjoint; contents reach them but for rounding
      before = enter;
    }
  }
}

TEST(PathsOfRays, EndWhereTheRayEnds) {
  const odprt::Cut cut = cut_ball(40);
  LifeRay life;  // along x, through the middle
  life.ray.origin[0] = -3, life.ray.origin[1] = 0.1f, life.ray.origin[2] = 0.05f;
  life.ray.direction[0] = 1;
  life.ray.t_max = std::numeric_limits<float>::infinity();
  const Paths through = paths_of(cut, std::span(&life, 1));
  life.ray.t_max = 3;  // the middle: one side only
  const Paths half = paths_of(cut, std::span(&life, 1));
  life.ray.t_max = 1;  // outside
  const Paths none = paths_of(cut, std::span(&life, 1));
  EXPECT_GT(through.visits.size(), half.visits.size());
  EXPECT_GT(half.visits.size(), none.visits.size());
  for (const Visit& v : none.visits) EXPECT_EQ(v.owner, kDirectory);
}

TEST(PathsOfRays, AreTheOwnersBelowTheRootsOfSubtrees) {
  const odprt::Cut cut = cut_ball(40);
  const std::vector<LifeRay> lives = random_lives(100);
  const Paths paths = find_paths(ball().wide, cut, std::vector<std::uint32_t>(cut.subtrees.size(), 7), lives,
                                 ball().geometry.space);
  ASSERT_EQ(paths.n_rays(), 100u);
  std::size_t n_stays = 0;
  for (std::size_t i = 0; i < paths.n_rays(); ++i) {
    ASSERT_FALSE(paths.of(i).empty());
    for (std::size_t k = 0; k < paths.of(i).size(); ++k, ++n_stays)
      EXPECT_EQ(paths.of(i)[k].owner, k % 2 == 0 ? kDirectory : 7u) << "by turns, from the root on";
  }
  EXPECT_GT(n_stays, 200u);
}

TEST(CostsOfOwners, BelongToWhereRaysAreAndEnd) {
  Paths paths;
  paths.visits = {{kDirectory, 1}, {0, 2}, {kDirectory, 4}, {1, 8}, {kDirectory, 16}};
  paths.first = {0, 4, 5};
  std::vector<LifeRay> lives(2);
  lives[0].hit = true;
  lives[1].parent = 0;  // meets nothing: belongs to where its parent ended
  lives[1].hit = true, lives[1].kind = LifeKind::shadow;
  EXPECT_EQ(costs_of_owners(paths, lives, 2, 100), (std::vector<double>{6, 124}));
}

}  // namespace
}  // namespace kdray::bench
