// Refitted forms: a place of a moved triangle lies in a leaf that names it, below boxes that hold it,
// whatever cells had cut the triangle; an unmoved form keeps its bounds but for the rounding of bytes; costs
// are those of a sum written down plainly.
#include "accel/flatten/refit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "accel/flatten/collapse.h"
#include "accel/flatten/flat_of.h"
#include "accel/flatten/leaf_block.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/shapes.h"

namespace kdray::flatten {
namespace {

using test::Random;

constexpr std::uint64_t kSeed = 5;

dvec3 at_weights(const layout::Triangle& t, double v, double w) {
  dvec3 p;
  for (int k = 0; k < 3; ++k) p[k] = (1 - v - w) * t.v[0][k] + v * t.v[1][k] + w * t.v[2][k];
  return p;
}

bool holds(const Box& box, const dvec3& p, double slack) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < box.lo[k] - slack || p[k] > box.hi[k] + slack) return false;
  return true;
}

layout::Triangle random_triangle(Random& random, float size) {
  scene::Geometry g;
  test::add_triangles(g, random, 1, size);
  return g.triangles[0];
}

// ---- Pieces

// One triangle as a block.
struct OneBlock {
  std::uint32_t block;
  std::vector<layout::u32> words;
  std::vector<std::uint8_t> pieces;

  OneBlock(const layout::Triangle& t, std::uint32_t width)
      : block(width), words(KDRAY_TRIANGLE_ROWS * width) {
    put(t);
    pieces.resize(Pieces::kRows * width, Piece::kNowhere);
  }
  void put(const layout::Triangle& t) {
    const auto rows = rows_of(t);
    for (std::size_t r = 0; r < rows.size(); ++r) words[r * block] = bits(rows[r]);
  }
  void cut(const Box& box) {
    const Piece piece = piece_of(TriangleInBlock{words.data(), block}, box);
    for (std::size_t i = 0; i < Pieces::kRows; ++i) pieces[i * block] = piece.corners[i / 2][i % 2];
  }
  Box bounds() const { return bounds_of_pieces(words.data(), pieces.data(), 1, block); }
};

TEST(Pieces, MoveWithTheirTriangles) {
  Random random(kSeed);
  int held = 0;
  for (int round = 0; round < 3000; ++round) {
    const layout::Triangle t = random_triangle(random, 2), moved = random_triangle(random, 2);
    Box box;
    const dvec3 in = at_weights(t, 0.3, 0.3);
    const vec3 side = test::random_vec3(random, 0, 1);
    box.lo = vec3(in) - side * side;
    box.hi = vec3(in) + test::random_vec3(random, 0, 1) * side;
    OneBlock at(t, round % 2 ? 4 : 8);
    at.cut(box);
    at.put(moved);
    const Box bounds = at.bounds();
    for (int i = 0; i <= 24; ++i)
      for (int j = 0; i + j <= 24; ++j) {
        if (!holds(box, at_weights(t, i / 24.0, j / 24.0), 0)) continue;
        ++held;
        ASSERT_TRUE(holds(bounds, at_weights(moved, i / 24.0, j / 24.0), 1e-12))
            << "seed " << kSeed << ", round " << round;
      }
  }
  EXPECT_GT(held, 30000);
}

TEST(Pieces, OfWholeTrianglesAreExactAndOthersNearlySo) {
  Random random(kSeed);
  for (int round = 0; round < 1000; ++round) {
    const layout::Triangle t = random_triangle(random, 2);
    const Box all = scene::bounds_of(t);
    OneBlock at(t, 8);
    at.cut(all);
    EXPECT_EQ(at.bounds().lo, all.lo);
    EXPECT_EQ(at.bounds().hi, all.hi);
    Box half = all;  // a plane's cut has four corners at most, which are kept as they are
    half.hi[round % 3] = all.center()[round % 3];
    at.cut(half);
    const Box cut = at.bounds();
    const vec3 extent = all.extent();
    EXPECT_LE(cut.hi[round % 3] - half.hi[round % 3], 0.01f * extent[round % 3] + 1e-6f);
    EXPECT_TRUE(all.contains(cut));
  }
}

TEST(Pieces, OfTrianglesBesideTheirLeafAreNothing) {
  Random random(kSeed);
  const layout::Triangle t = random_triangle(random, 2);
  Box beside = scene::bounds_of(t);
  beside.lo.x = beside.hi.x + 1;
  beside.hi.x = beside.lo.x + 1;
  OneBlock at(t, 4);
  at.cut(beside);
  EXPECT_TRUE(at.bounds().empty());
}

// ---- Forms

struct Subject {
  std::string name;
  scene::Geometry geometry;
  FlatScene flat;
  WideForm wide;
};

std::vector<Subject> subjects() {
  Random random(kSeed);
  std::vector<std::pair<std::string, scene::Geometry>> geometries(5);
  geometries[0].first = "small";
  test::add_triangles(geometries[0].second, random, 3000, 0.4f);
  geometries[1].first = "large";
  test::add_triangles(geometries[1].second, random, 300, 6);
  geometries[2] = {"mixed", test::mixed_geometry(random, 500, 0.8f)};
  geometries[3].first = "architecture";
  test::add_architecture(geometries[3].second, random, 500);
  geometries[4].first = "none";
  std::vector<Subject> made;
  for (const auto& [name, geometry] : geometries)
    for (const bool groups : {false, true})
      for (const int block : {4, 8}) {
        kdtree::BuildConfig config;
        config.groups = groups;
        config.block = block;
        const kdtree::Tree tree = kdtree::build(geometry, config);
        const FlatScene flat = flat_of(geometry, tree);
        made.push_back({name + (groups ? ", groups" : "") + ", in blocks of " + std::to_string(block),
                        geometry, flat, make_wide(tree, flat, block)});
      }
  return made;
}

// The triangles elsewhere, each by itself: no cell's planes are left.
Array<layout::Triangle> moved(const Array<layout::Triangle>& triangles, Random& random) {
  auto all = Array<layout::Triangle>::copy_of({triangles.data(), triangles.size()});
  for (layout::Triangle& t : all)
    for (auto& corner : t.v) {
      const vec3 by = test::random_vec3(random, -1, 1);
      for (int k = 0; k < 3; ++k) corner[k] += by[k];
    }
  return all;
}

// Whether a walk that opens the boxes which hold p comes to a leaf that names the triangle.
bool is_found(const WideForm& form, std::size_t index, std::uint32_t triangle, const dvec3& p) {
  const layout::WideNode& node = form.nodes[index];
  const auto block = static_cast<std::uint32_t>(form.block);
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    if (!has_child(node, slot) || !holds(bounds_of_child(node, slot), p, 1e-12)) continue;
    const layout::u32 child = node.child[slot];
    if (!is_leaf(child)) {
      if (is_found(form, child, triangle, p)) return true;
    } else if (is_leaf_of<primitives::TriangleKind>(child)) {
      bool more = true;
      for (std::size_t i = child & KDRAY_WIDE_FIRST_MASK; more; ++i) {
        const LeafBlock at(form.triangle_blocks, i, block);
        for (std::uint32_t lane = 0; lane < at.n; ++lane)
          if (at.index(lane) == triangle) return true;
        more = !at.is_last;
      }
    }
  }
  return false;
}

template <class T>
bool same_bits(const Array<T>& a, const Array<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}

TEST(RefitForm, LeadsToEveryPlaceOfEveryTriangle) {
  Random random(kSeed);
  for (const Subject& s : subjects()) {
    SCOPED_TRACE(s.name);
    const Pieces pieces(s.wide);
    WideForm form = s.wide;
    for (int step = 0; step < 2; ++step) {  // and a refit of a refit
      const Array<layout::Triangle> triangles = moved(s.flat.triangles, random);
      form = refit(form, pieces, triangles).form;
      for (std::uint32_t i = 0; i < triangles.size(); ++i)
        for (int sample = 0; sample < 12; ++sample) {
          double v = std::generate_canonical<double, 53>(random),
                 w = std::generate_canonical<double, 53>(random);
          if (sample < 3) v = sample == 1, w = sample == 2;  // the corners
          if (v + w > 1) v = 1 - v, w = 1 - w;
          ASSERT_TRUE(is_found(form, 0, i, at_weights(triangles[i], v, w))) << "triangle " << i;
        }
    }
  }
}

TEST(RefitForm, OfWhatHasNotMovedIsTheSameButForBytes) {
  for (const Subject& s : subjects()) {
    SCOPED_TRACE(s.name);
    const Refit same = refit(s.wide, Pieces(s.wide), s.flat.triangles);
    EXPECT_TRUE(same_bits(same.form.triangle_blocks, s.wide.triangle_blocks));
    EXPECT_EQ(same.form.sphere_blocks.data(), s.wide.sphere_blocks.data());
    // Pieces of many corners are hexagons; on the other hand they are cut by all of a cell's planes.
    EXPECT_NEAR(same.cost, expected_cost(s.wide), 0.1 * same.cost);
    EXPECT_EQ(same.cost, expected_cost(same.form));
    for (std::size_t i = 0; i < s.wide.nodes.size(); ++i)
      EXPECT_EQ(std::memcmp(same.form.nodes[i].child, s.wide.nodes[i].child, sizeof s.wide.nodes[i].child),
                0);
  }
}

// ---- Orders

std::vector<std::uint32_t> slots_of(const layout::WideNode& node, std::size_t octant) {
  std::vector<std::uint32_t> near_to_far;
  for (std::uint32_t i = 0; i < kWidth; ++i) near_to_far.push_back(node.order[octant] >> (3 * (7 - i)) & 7u);
  return near_to_far;
}

// Whether a ray of the octant may meet box a, and box b after it.
bool leads(const layout::WideNode& node, std::uint32_t a, std::uint32_t b, std::size_t octant) {
  bool may = true;
  for (std::size_t k = 0; k < 3; ++k)
    may &= octant >> k & 1 ? node.bounds[k][0][b] < node.bounds[k][1][a]
                           : node.bounds[k][1][b] > node.bounds[k][0][a];
  return may;
}

// The most that a walk has on its stack which pushes all children of a node.
int height_of(const WideForm& form, std::size_t index, std::size_t octant, int height) {
  const layout::WideNode& node = form.nodes[index];
  int n = 0, most = 0;
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) n += has_child(node, slot);
  most = height + n;
  const std::vector<std::uint32_t> slots = slots_of(node, octant);
  for (int i = 0; i < n; ++i)
    if (const layout::u32 child = node.child[slots[static_cast<std::size_t>(i)]]; !is_leaf(child))
      most = std::max(most, height_of(form, child, octant, height + n - 1 - i));
  return most;
}

// Of pairs of children, in all octants, those that are visited the wrong way round, and all.
struct Pairs {
  std::size_t wrong = 0, all = 0;

  void add(const layout::WideNode& node, std::size_t octant) {
    const std::vector<std::uint32_t> slots = slots_of(node, octant);
    for (std::uint32_t i = 0; i < kWidth && has_child(node, slots[i]); ++i)
      for (std::uint32_t j = 0; j < i; ++j) {
        ++all;
        wrong += leads(node, slots[i], slots[j], octant) && !leads(node, slots[j], slots[i], octant);
      }
  }
};

void check_orders(const WideForm& form) {
  int stack = 0;
  for (std::size_t octant = 0; octant < 8; ++octant) {
    stack = std::max(stack, height_of(form, 0, octant, 0));
    for (const layout::WideNode& node : form.nodes) {
      const std::vector<std::uint32_t> slots = slots_of(node, octant);
      std::uint32_t seen = 0;
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        seen |= 1u << slots[i];
        ASSERT_TRUE(i == 0 || has_child(node, slots[i - 1]) || !has_child(node, slots[i]))
            << "those without child are the farthest";
      }
      ASSERT_EQ(seen, 0xffu);
    }
  }
  EXPECT_EQ(stack, form.stack_size);
}

TEST(RefitForm, OrdersAreWholeOnAStackThatIsLargeEnough) {
  Random random(kSeed);
  for (const Subject& s : subjects()) {
    SCOPED_TRACE(s.name);
    const Pieces pieces(s.wide);
    check_orders(refit(s.wide, pieces, s.flat.triangles).form);
    check_orders(refit(s.wide, pieces, moved(s.flat.triangles, random)).form);
  }
}

// Where cells are parted by planes, what is right stays right.
TEST(RefitForm, OrdersOfPlanesStayFrontToBack) {
  for (const Subject& s : subjects()) {
    if (s.name.find("groups") != std::string::npos) continue;
    SCOPED_TRACE(s.name);
    Pairs pairs;
    for (layout::WideNode node : s.wide.nodes) {
      std::uint32_t n = 0;
      for (std::uint32_t slot = 0; slot < kWidth; ++slot) n += has_child(node, slot);
      order_anew(node, n);
      for (std::size_t octant = 0; octant < 8; ++octant) pairs.add(node, octant);
    }
    EXPECT_EQ(pairs.wrong, 0) << "of " << pairs.all;
  }
}

// A scene that is turned by half a circle: orders are turned with it, where cells are parted by planes.
TEST(RefitForm, OrdersTurnWithTheScene) {
  for (const Subject& s : subjects()) {
    if (s.name.find("groups") != std::string::npos || s.flat.spheres.size() > 0) continue;
    SCOPED_TRACE(s.name);
    auto turned = Array<layout::Triangle>::copy_of({s.flat.triangles.data(), s.flat.triangles.size()});
    for (layout::Triangle& t : turned)
      for (auto& corner : t.v) corner[0] = -corner[0], corner[1] = -corner[1];
    const WideForm form = refit(s.wide, Pieces(s.wide), turned).form;
    Pairs pairs;
    for (const layout::WideNode& node : form.nodes)
      for (std::size_t octant = 0; octant < 8; ++octant) pairs.add(node, octant);
    EXPECT_LE(pairs.wrong, pairs.all / 50) << pairs.all;
  }
}

TEST(RefitForm, IsTheSameForAnyNumberOfThreads) {
  Random random(kSeed);
  const std::vector<Subject> all = subjects();
  const Subject& s = all.front();
  const Array<layout::Triangle> triangles = moved(s.flat.triangles, random);
  const Refit many = refit(s.wide, Pieces(s.wide), triangles);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Refit alone = refit(s.wide, Pieces(s.wide), triangles);
  EXPECT_TRUE(same_bits(many.form.nodes, alone.form.nodes));
  EXPECT_TRUE(same_bits(many.form.triangle_blocks, alone.form.triangle_blocks));
  EXPECT_EQ(many.cost, alone.cost);
}

// The sum over all children, in any order: a node is a step, and so is a block of a leaf.
TEST(RefitForm, CostsAreThoseOfTheHeuristic) {
  for (const Subject& s : subjects()) {
    SCOPED_TRACE(s.name);
    double sum = 0;
    Box root;
    for (const layout::WideNode& node : s.wide.nodes)
      for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
        if (!has_child(node, slot)) continue;
        const Box box = bounds_of_child(node, slot);
        if (&node == s.wide.nodes.data()) root.grow(box);
        std::size_t steps = 1;
        if (is_leaf(node.child[slot]))
          primitives::with_kind(leaf_kind(node.child[slot]), [&](auto kind) {
            using Kind = decltype(kind);
            const std::size_t words = static_cast<std::size_t>(Kind::kRows * s.wide.block);
            std::size_t end = ((node.child[slot] & KDRAY_WIDE_FIRST_MASK) + 1) * words;
            for (; (Kind::blocks_of(s.wide)[end - 1] & KDRAY_WIDE_LAST) == 0; end += words) ++steps;
          });
        sum += static_cast<double>(box.area()) * static_cast<double>(steps);
      }
    const double expected = root.empty() ? 0 : 1 + sum / static_cast<double>(root.area());
    EXPECT_NEAR(expected_cost(s.wide), expected, 1e-5 * expected);
  }
}

}  // namespace
}  // namespace kdray::flatten
