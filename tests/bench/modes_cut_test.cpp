// What    Pieces of real trees, and the ways of rays through them: nothing is lost, hits lie in the last piece, costs don't
//         depend on the cut. Random rays have seed 5.
#include "bench/modes_cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "bench/meshes.h"
#include "bench/modes_paths.h"
#include "bench/random.h"
#include "prepare/prepared.h"

namespace kdray::bench {
namespace {

const prepare::Prepared& ball() {
  static const prepare::Prepared kBall = prepare::prepare(displaced_sphere_of(5000), TreeOptions{});
  return kBall;
}

std::vector<LifeRay> random_lives(std::size_t n) {
  Random random(5);
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

double sum_of(const Paths& paths) {
  double sum = 0;
  for (const PieceVisit& v : paths.visits) sum += v.cost;
  return sum;
}

TEST(CutTree, HasAsManyPiecesAsAreWanted) {
  for (const std::size_t n : {1u, 2u, 10u, 100u}) {
    const std::size_t found = Cut(ball().wide, n).pieces().size();
    EXPECT_GE(found, n);
    EXPECT_LT(found, n + 8);  // what one opening adds
  }
}

TEST(CutTree, IsAllLeavesAtTheEnd) {
  const Cut cut(ball().wide, std::numeric_limits<std::size_t>::max());
  for (const Piece& piece : cut.pieces()) EXPECT_NE(piece.child & KDRAY_WIDE_LEAF, 0u);
}

TEST(CutTree, PiecesAndDirectoryMakeUpTheWholeForm) {
  for (const std::size_t n : {1u, 7u, 100u, 1000000u}) {
    const Cut cut(ball().wide, n);
    std::size_t bytes = 0, roots = 0;
    for (const Piece& piece : cut.pieces())
      bytes += piece.bytes, roots += (piece.child & KDRAY_WIDE_LEAF) == 0;
    std::size_t n_roots = 0;
    for (std::uint32_t i = 0; i < ball().wide.nodes.size(); ++i)
      n_roots += cut.piece_of_node(i) != kDirectory;
    EXPECT_EQ(n_roots, roots);
    EXPECT_LE(bytes, ball().wide.bytes());
    if (n == 1) {
      EXPECT_EQ(bytes, ball().wide.bytes());
    }
    EXPECT_GE(bytes, ball().wide.bytes() - ball().wide.nodes.bytes());  // all the blocks
  }
}

TEST(CutTree, OpensTheDearestNext) {
  const Cut cut(ball().wide, 50);
  const Cut next(ball().wide, cut.pieces().size() + 1);
  std::vector<Piece> gone;
  const Piece* dearest = nullptr;
  for (const Piece& piece : cut.pieces()) {
    const auto same = [&](const Piece& other) { return other.child == piece.child; };
    if (std::none_of(next.pieces().begin(), next.pieces().end(), same)) gone.push_back(piece);
    const bool is_leaf = (piece.child & KDRAY_WIDE_LEAF) != 0;
    if (!is_leaf && (dearest == nullptr || piece.cost > dearest->cost)) dearest = &piece;
  }
  ASSERT_EQ(gone.size(), 1u);
  ASSERT_NE(dearest, nullptr);
  EXPECT_EQ(gone[0].child, dearest->child);
}

TEST(PathsOfRays, CostTheSameWhateverTheCut) {
  const std::vector<LifeRay> lives = random_lives(500);
  const double whole = sum_of(find_paths(ball().wide, Cut(ball().wide, 1), lives, ball().geometry.center));
  EXPECT_GT(whole, 500);  // each visits the root at least
  for (const std::size_t n : {2u, 30u, 1000u}) {
    const Cut cut(ball().wide, n);
    EXPECT_NEAR(sum_of(find_paths(ball().wide, cut, lives, ball().geometry.center)), whole, 1e-6 * whole);
  }
}

TEST(PathsOfRays, OfOnePieceAreOneStay) {
  const std::vector<LifeRay> lives = random_lives(100);
  const Paths paths = find_paths(ball().wide, Cut(ball().wide, 1), lives, ball().geometry.center);
  ASSERT_EQ(paths.n_rays(), 100u);
  for (std::size_t i = 0; i < paths.n_rays(); ++i) {
    ASSERT_EQ(paths.of(i).size(), 1u);
    EXPECT_EQ(paths.of(i)[0].piece, 0u);
  }
}

// The pieces' boxes that a line from the outside passes, sorted by where it enters them, are the path.
TEST(PathsOfRays, GoFromNearToFar) {
  const Cut cut(ball().wide, 40);
  for (const LifeRay& life : random_lives(300)) {
    const Paths paths = find_paths(ball().wide, cut, std::span(&life, 1), ball().geometry.center);
    double before = -std::numeric_limits<double>::infinity();
    for (const PieceVisit& v : paths.of(0)) {
      if (v.piece == kDirectory) continue;
      const Box& box = cut.pieces()[v.piece].box;
      double enter = 0, leave = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) {
        const double origin = life.ray.origin[k] - ball().geometry.center[k], along = life.ray.direction[k];
        const double a = (box.lo[k] - origin) / along, b = (box.hi[k] - origin) / along;
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      EXPECT_LE(enter, leave * (1 + 1e-6));
      EXPECT_GE(enter, before - 1e-5);  // cells are disjoint; contents reach them but for rounding
      before = enter;
    }
  }
}

TEST(PathsOfRays, EndWhereTheRayEnds) {
  const Cut cut(ball().wide, 40);
  LifeRay life;  // along x, through the middle
  life.ray.origin[0] = -3, life.ray.origin[1] = 0.1f, life.ray.origin[2] = 0.05f;
  life.ray.direction[0] = 1;
  life.ray.t_max = std::numeric_limits<float>::infinity();
  const Paths through = find_paths(ball().wide, cut, std::span(&life, 1), ball().geometry.center);
  life.ray.t_max = 3;  // the middle: one side only
  const Paths half = find_paths(ball().wide, cut, std::span(&life, 1), ball().geometry.center);
  life.ray.t_max = 1;  // outside
  const Paths none = find_paths(ball().wide, cut, std::span(&life, 1), ball().geometry.center);
  EXPECT_GT(through.visits.size(), half.visits.size());
  EXPECT_GT(half.visits.size(), none.visits.size());
  for (const PieceVisit& v : none.visits) EXPECT_EQ(v.piece, kDirectory);
}

TEST(CostsOfPieces, BelongToWhereRaysAreAndEnd) {
  Paths paths;
  paths.visits = {{kDirectory, 1}, {0, 2}, {kDirectory, 4}, {1, 8}, {kDirectory, 16}};
  paths.first = {0, 4, 5};
  std::vector<LifeRay> lives(2);
  lives[0].hit = true;
  lives[1].parent = 0;  // meets no piece: belongs to where its parent ended
  lives[1].hit = true, lives[1].kind = LifeKind::shadow;
  EXPECT_EQ(costs_of_pieces(paths, lives, 2, 100), (std::vector<double>{6, 124}));
}

}  // namespace
}  // namespace kdray::bench
