// What    The cut of the wide form: every leaf lies in exactly one subtree, costs and bounds add up, and
//         there are as many as were asked for where the tree has them.
#include "engine/odprt/subtrees.h"

#include <gtest/gtest.h>

#include <map>

#include "engine/odprt/prepared_scenes.h"

namespace kdray::test {
namespace {

using odprt::Cut;
using odprt::OpenedNode;

// Counts the leaves below a child, by their word.
void count_leaves(const flatten::WideForm& form, layout::u32 child, std::map<layout::u32, int>& leaves) {
  if (child & KDRAY_WIDE_LEAF) {
    ++leaves[child];
    return;
  }
  const layout::WideNode& node = form.nodes[child];
  for (std::uint32_t slot = 0; slot < 8; ++slot)
    if (!odprt::bounds_of_child(node, slot).empty()) count_leaves(form, node.child[slot], leaves);
}

std::map<layout::u32, int> all_leaves(const flatten::WideForm& form) {
  std::map<layout::u32, int> leaves;
  for (const layout::WideNode& node : form.nodes)
    for (std::uint32_t slot = 0; slot < 8; ++slot)
      if (!odprt::bounds_of_child(node, slot).empty() && (node.child[slot] & KDRAY_WIDE_LEAF))
        ++leaves[node.child[slot]];
  return leaves;
}

double cost_of_whole(const flatten::WideForm& form) {
  double cost = 0;
  for (const layout::WideNode& node : form.nodes)
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      const Box box = odprt::bounds_of_child(node, slot);
      if (box.empty()) continue;
      const bool leaf = node.child[slot] & KDRAY_WIDE_LEAF;
      cost +=
          static_cast<double>(box.area()) * (leaf ? 2.0 * odprt::leaf_blocks(form, node.child[slot]) : 1.0);
    }
  return cost;
}

TEST(Subtrees, EveryLeafLiesInOne) {
  for (const auto& [name, scene] : prepared_scenes())
    for (const std::size_t n : {1u, 7u, 64u, 100000u}) {
      const Cut cut = odprt::cut(scene.flat, scene.wide, n);
      std::map<layout::u32, int> leaves;
      for (const odprt::Subtree& s : cut.subtrees) count_leaves(scene.wide, s.child, leaves);
      EXPECT_EQ(leaves, all_leaves(scene.wide)) << name << " in " << n;
    }
}

TEST(Subtrees, TheTopNamesEachOnce) {
  for (const auto& [name, scene] : prepared_scenes()) {
    const Cut cut = odprt::cut(scene.flat, scene.wide, 50);
    std::vector<int> named(cut.subtrees.size()), opened(cut.top.size());
    for (const OpenedNode& top : cut.top)
      for (std::uint32_t slot = 0; slot < 8; ++slot) {
        const std::int32_t below = top.below[slot];
        const layout::WideNode& node = scene.wide.nodes[top.node];
        EXPECT_EQ(below == OpenedNode::kEmpty, odprt::bounds_of_child(node, slot).empty()) << name;
        if (below == OpenedNode::kEmpty) continue;
        if (below >= 0) {
          ++opened[static_cast<std::size_t>(below)];
          EXPECT_EQ(cut.top[static_cast<std::size_t>(below)].node, node.child[slot]);
        } else {
          ++named[static_cast<std::size_t>(-1 - below)];
          EXPECT_EQ(cut.subtrees[static_cast<std::size_t>(-1 - below)].child, node.child[slot]);
        }
      }
    for (const int n : named) EXPECT_EQ(n, 1) << name;
    for (std::size_t i = 1; i < opened.size(); ++i) EXPECT_EQ(opened[i], 1) << name;
  }
}

TEST(Subtrees, CostsAddUpToTheWhole) {
  for (const auto& [name, scene] : prepared_scenes()) {
    const Cut cut = odprt::cut(scene.flat, scene.wide, 40);
    double cost = 0;
    for (const odprt::Subtree& s : cut.subtrees) {
      cost += s.cost;
      EXPECT_GE(s.visit, 0);
    }
    // What the opened nodes cost is nobody's.
    for (std::size_t i = 1; i < cut.top.size(); ++i)
      for (std::size_t k = 0; k < cut.top.size(); ++k)
        for (std::uint32_t slot = 0; slot < 8; ++slot)
          if (cut.top[k].below[slot] == static_cast<std::int32_t>(i))
            cost +=
                static_cast<double>(odprt::bounds_of_child(scene.wide.nodes[cut.top[k].node], slot).area());
    EXPECT_NEAR(cost, cost_of_whole(scene.wide), 1e-9 * cost_of_whole(scene.wide)) << name;
  }
}

TEST(Subtrees, AsManyAsAreAskedFor) {
  const prepare::Prepared scene = prepare::prepare(smooth_meshes(), TreeOptions());
  for (const std::size_t n : {10u, 64u, 120u}) {
    const std::size_t got = odprt::cut(scene.flat, scene.wide, n).subtrees.size();
    EXPECT_GE(got, n);
    EXPECT_LT(got, n + 8);
  }
}

}  // namespace
}  // namespace kdray::test
