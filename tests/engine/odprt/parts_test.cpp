// What    The parts of a divided scene: together they hold every leaf of the whole, each once, with the same
//         boxes and the same numbers in their blocks; primitives that lie in several parts are known to; the
//         directory encloses what the parts hold.
#include "engine/odprt/division.h"

#include "engine/odprt/subtrees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "engine/odprt/assign.h"
#include "engine/odprt/prepared_scenes.h"

namespace kdray::test {
namespace {

using odprt::blocks_of;
using odprt::kBlockRows;

constexpr std::uint64_t kPartsSeed = 23;
std::uint32_t number_of(const flatten::FlatScene& scene, std::uint32_t kind, std::uint32_t index) {
  return primitives::with_kind(kind, [&](auto k) { return decltype(k)::of(scene)[index].number; });
}

// A leaf by what a ray sees of it: its box, its kind, its words with numbers for indices.
using Leaf = std::tuple<std::vector<float>, std::uint32_t, std::vector<layout::u32>>;

Leaf leaf_of(const flatten::FlatScene& scene, const flatten::WideForm& form, layout::u32 word,
             const Box& box) {
  const std::uint32_t kind = flatten::leaf_kind(word);
  const auto& blocks = blocks_of(form, kind);
  const auto width = static_cast<std::size_t>(form.block);
  const std::size_t words = kBlockRows[kind] * width;
  const layout::u32* const first = blocks.data() + (word & KDRAY_WIDE_FIRST_MASK) * words;
  std::vector<layout::u32> all(first, first + odprt::leaf_blocks(form, word) * words);
  for (std::size_t b = 0; b < all.size(); b += words)
    for (std::size_t lane = 0; lane < width; ++lane) {
      layout::u32& index = all[b + (kBlockRows[kind] - 1) * width + lane];
      const layout::u32 last = index & KDRAY_WIDE_LAST;
      index = number_of(scene, kind, index & ~KDRAY_WIDE_LAST) | last;
      if (last) break;
    }
  return {{box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}, kind, all};
}

// The boxes by which a walk enters what a subtree holds: those of its root's children.
std::vector<Box> boxes_below(const flatten::WideForm& form, const odprt::Subtree& subtree) {
  if (subtree.child & KDRAY_WIDE_LEAF) return {subtree.bounds};
  std::vector<Box> boxes;
  for (std::uint32_t slot = 0; slot < 8; ++slot) {
    const Box box = odprt::bounds_of_child(form.nodes[subtree.child], slot);
    if (!box.empty()) boxes.push_back(box);
  }
  return boxes;
}

// Every leaf that a walk from the root can come to.
std::vector<Leaf> leaves_of(const flatten::FlatScene& scene, const flatten::WideForm& form) {
  std::vector<Leaf> leaves;
  if (form.nodes.empty()) return leaves;
  std::vector<layout::u32> stack{0};
  while (!stack.empty()) {
    const layout::WideNode& node = form.nodes[stack.back()];
    stack.pop_back();
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      const Box box = odprt::bounds_of_child(node, slot);
      if (box.empty()) continue;
      if (node.child[slot] & KDRAY_WIDE_LEAF)
        leaves.push_back(leaf_of(scene, form, node.child[slot], box));
      else
        stack.push_back(node.child[slot]);
    }
  }
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

Box box_of(const layout::PartCell& c) {
  return {{c.lo[0], c.lo[1], c.lo[2]}, {c.hi[0], c.hi[1], c.hi[2]}};
}

// Any part for each subtree: not only runs of neighbours. Some subtrees are everywhere, if that is asked for.
std::vector<std::uint32_t> random_parts(std::size_t n, std::uint32_t n_parts, bool replicated,
                                        std::mt19937_64& random) {
  std::vector<std::uint32_t> parts(n);
  for (std::uint32_t& part : parts)
    part =
        replicated && random() % 3 == 0 ? odprt::kEveryPart : static_cast<std::uint32_t>(random() % n_parts);
  return parts;
}

std::size_t leaves_below(const flatten::WideForm& form, layout::u32 child) {
  if (child & KDRAY_WIDE_LEAF) return 1;
  std::size_t n = 0;
  for (std::uint32_t slot = 0; slot < 8; ++slot)
    if (!odprt::bounds_of_child(form.nodes[child], slot).empty())
      n += leaves_below(form, form.nodes[child].child[slot]);
  return n;
}

class Parts : public testing::Test {
 protected:
  // Calls check(name, scene, cut, part_of, parts) for all scenes, cut into few and many subtrees.
  template <class Check>
  void for_all(const Check& check) {
    std::mt19937_64 random(kPartsSeed);
    for (const auto& [name, scene] : prepared_scenes())
      for (const std::uint32_t n_parts : {2u, 5u, 64u})
        for (const bool replicated : {false, true}) {
          const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 4 * n_parts);
          const auto part_of = random_parts(cut.subtrees.size(), n_parts, replicated, random);
          check(name, scene, cut, part_of, odprt::make_parts(scene.flat, scene.wide, cut, part_of, n_parts));
        }
  }
};

TEST_F(Parts, HoldEveryLeafOnceOrAllOfThemDo) {
  for_all([](const std::string& name, const prepare::Prepared& scene, const odprt::Cut& cut,
             const auto& part_of, const std::vector<odprt::Part>& parts) {
    std::size_t n_replicated = 0;
    for (std::size_t i = 0; i < cut.subtrees.size(); ++i)
      if (part_of[i] == odprt::kEveryPart) n_replicated += leaves_below(scene.wide, cut.subtrees[i].child);
    std::vector<Leaf> leaves;
    for (const odprt::Part& part : parts) {
      const std::vector<Leaf> own = leaves_of(part.flat, part.wide);
      leaves.insert(leaves.end(), own.begin(), own.end());
    }
    std::sort(leaves.begin(), leaves.end());
    std::vector<Leaf> whole = leaves_of(scene.flat, scene.wide);
    EXPECT_EQ(leaves.size(), whole.size() + (parts.size() - 1) * n_replicated) << name;
    if (n_replicated > 0) {
      leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
      whole.erase(std::unique(whole.begin(), whole.end()), whole.end());
    }
    // Many leaves: compared whole, told by their number.
    EXPECT_TRUE(leaves == whole) << name << ": " << leaves.size() << " leaves";
  });
}

TEST_F(Parts, SharedTrianglesComeFirstByNumber) {
  int n_shared = 0;
  for_all([&](const std::string& name, const prepare::Prepared&, const odprt::Cut&, const auto&,
              const std::vector<odprt::Part>& parts) {
    std::map<std::uint32_t, int> holders;
    for (const odprt::Part& part : parts)
      for (const layout::Triangle& t : part.flat.triangles) ++holders[t.number];
    for (const odprt::Part& part : parts) {
      for (std::size_t i = 0; i < part.flat.triangles.size(); ++i) {
        const std::uint32_t number = part.flat.triangles[i].number;
        EXPECT_EQ(holders[number] > 1, i < part.n_shared) << name;
        if (i > 0 && i < part.n_shared) {
          EXPECT_LT(part.flat.triangles[i - 1].number, number) << name;
        }
      }
      n_shared += static_cast<int>(part.n_shared);
    }
  });
  EXPECT_GT(n_shared, 10);
}

TEST_F(Parts, NormalsFollowTheirTriangles) {
  for_all([](const std::string& name, const prepare::Prepared& scene, const odprt::Cut&, const auto&,
             const std::vector<odprt::Part>& parts) {
    std::map<std::uint32_t, layout::Triangle> whole;
    for (const layout::Triangle& t : scene.flat.triangles) whole[t.number] = t;
    for (const odprt::Part& part : parts)
      for (const layout::Triangle& t : part.flat.triangles) {
        const layout::Triangle& same = whole.at(t.number);
        EXPECT_EQ(t.material, same.material);
        ASSERT_EQ(t.normals == KDRAY_NO_NORMALS, same.normals == KDRAY_NO_NORMALS);
        if (t.normals == KDRAY_NO_NORMALS) continue;
        ASSERT_EQ(t.normals & KDRAY_ZERO_AREA, same.normals & KDRAY_ZERO_AREA);
        const layout::VertexNormals &a = part.flat.normals[t.normals & KDRAY_NORMALS_MASK],
                                    &b = scene.flat.normals[same.normals & KDRAY_NORMALS_MASK];
        EXPECT_TRUE(std::equal(&a.n[0][0], &a.n[0][0] + 9, &b.n[0][0])) << name;
      }
  });
}

TEST_F(Parts, TheDirectoryEnclosesThem) {
  for_all([](const std::string& name, const prepare::Prepared& scene, const odprt::Cut& cut,
             const auto& part_of, const std::vector<odprt::Part>&) {
    const auto cells = odprt::make_directory(scene.wide, cut, part_of);
    EXPECT_TRUE(std::is_sorted(cells.begin(), cells.end(),
                               [](const auto& a, const auto& b) { return a.part < b.part; }));
    EXPECT_LE(cells.size(), 10 * cut.subtrees.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      ASSERT_LT(i + cells[i].n_below, cells.size());
      EXPECT_NE(cells[i].n_below, 1u) << name << ": a cell around one other";
      for (std::size_t k = i + 1; k <= i + cells[i].n_below; ++k) {
        EXPECT_EQ(cells[k].part, cells[i].part);
        EXPECT_LE(k + cells[k].n_below, i + cells[i].n_below) << name << ": cells overlap";
        EXPECT_TRUE(box_of(cells[i]).contains(box_of(cells[k]))) << name;
      }
    }
    for (std::size_t i = 0; i < cut.subtrees.size(); ++i) {
      if (part_of[i] == odprt::kEveryPart) continue;
      for (const Box& box : boxes_below(scene.wide, cut.subtrees[i])) {
        const bool enclosed = std::any_of(cells.begin(), cells.end(), [&](const layout::PartCell& c) {
          return c.n_below == 0 && c.part == part_of[i] && box_of(c).contains(box);
        });
        EXPECT_TRUE(enclosed) << name << " subtree " << i;
      }
    }
  });
}

TEST(Division, OnePartIsTheSceneItself) {
  const prepare::Prepared scene = prepare::prepare(smooth_meshes(), TreeOptions());
  const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 64);
  const std::vector<double> costs(cut.subtrees.size(), 1.0);
  const odprt::Division whole = odprt::divide(scene.flat, scene.wide, cut, costs, {});
  ASSERT_EQ(whole.parts.size(), 1u);
  EXPECT_EQ(whole.parts[0].wide.nodes.data(), scene.wide.nodes.data()) << "copied";
}

TEST(Division, NoPartTakesMuchMoreThanItsShareOfTheBytes) {
  const prepare::Prepared scene = prepare::prepare(smooth_meshes(), TreeOptions());
  const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 256);
  std::vector<double> costs(cut.subtrees.size(), 0.0);
  costs[0] = 1;  // all the cost in one place
  const std::size_t whole = odprt::geometry_bytes(scene.flat, scene.wide);
  for (const std::uint32_t n : {2u, 4u, 8u}) {
    const odprt::Division division =
        odprt::divide(scene.flat, scene.wide, cut, costs, {.n_parts = n, .spare = 0.15});
    for (const odprt::Part& part : division.parts)
      EXPECT_LE(static_cast<double>(part.geometry_bytes()), (1.0 / n + 0.20) * static_cast<double>(whole))
          << n;
  }
}

TEST(Division, WhatRaysComeToMostIsEverywhere) {
  const prepare::Prepared scene = prepare::prepare(smooth_meshes(), TreeOptions());
  const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 64);
  std::vector<double> costs;
  for (const odprt::Subtree& subtree : cut.subtrees) costs.push_back(subtree.visit);
  costs[7] *= 1000;
  for (const std::uint32_t n : {2u, 5u}) {
    const odprt::Division division =
        odprt::divide(scene.flat, scene.wide, cut, costs, {.n_parts = n, .spare = 0.15, .replicated = 0.1});
    EXPECT_EQ(division.part_of[7], odprt::kEveryPart);
    std::uint64_t all = 0, everywhere = 0;
    for (std::size_t i = 0; i < cut.subtrees.size(); ++i) {
      all += cut.subtrees[i].bytes;
      if (division.part_of[i] == odprt::kEveryPart) everywhere += cut.subtrees[i].bytes;
    }
    // n parts that share s of the whole hold s - s/n more than an equal share.
    EXPECT_LE(static_cast<double>(everywhere) * (1 - 1.0 / n), 0.1 * static_cast<double>(all));
    for (std::uint32_t part = 0; part < n; ++part) {
      const std::vector<std::uint32_t> subtrees = division.subtrees_of(part);
      EXPECT_TRUE(std::find(subtrees.begin(), subtrees.end(), 7u) != subtrees.end());
    }
  }
}

}  // namespace
}  // namespace kdray::test
