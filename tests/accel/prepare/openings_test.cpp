// What    Instances that are opened in the tree over them: the leaves of each hold all of its mesh, once, in
//         boxes that hold it where it lies; what lies by itself stays whole; there are no more leaves than
//         may be. Closed again, the tree has each instance once.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

#include "accel/flatten/instance_openings.h"
#include "accel/prepare/prepared.h"
#include "scene/generate/displaced_sphere.h"
#include "scene/model/instances.h"

namespace kdray::prepare {
namespace {

using scene::rotation, scene::scaling, scene::translation;

constexpr unsigned kSeed = 41;

// So many balls in a row, and one far off.
scene::Scene row_of_balls(int n, double apart, bool ground, std::size_t triangles = 20000) {
  std::mt19937 bits(kSeed);
  std::uniform_real_distribution<> angle(0, 6);
  scene::Scene s, ball = generate::displaced_sphere_of(triangles);
  s.materials = ball.materials;
  ball.materials.clear();
  s.meshes.push_back(std::make_shared<const scene::Scene>(std::move(ball)));
  for (int i = 0; i < n; ++i)
    s.instances.push_back(scene::instance_of(translation({apart * i, 0, 0}) *
                                                 rotation(glm::normalize(dvec3(1, 2, 3)), angle(bits)) *
                                                 scaling({i % 2 ? -1 : 1, 0.8, 1.2}),
                                             0));
  s.instances.push_back(scene::instance_of(translation({0, 500, 0}), 0));
  if (ground) {
    s.vertices = {{-9, -2, -9}, {9, -2, -9}, {0, -2, 9}};
    s.triangles = {{.vertex = {0, 1, 2}, .number = 0}};
  }
  return s;
}

Box box_of(const layout::WideNode& node, std::size_t slot) {
  Box box;
  for (int k = 0; k < 3; ++k) box.lo[k] = node.bounds[k][0][slot], box.hi[k] = node.bounds[k][1][slot];
  return box;
}

struct Leaf {
  Box box;
  std::uint32_t index;
};

// The leaves of the tree over instances.
std::vector<Leaf> leaves_of(const Prepared& p) {
  std::vector<Leaf> leaves;
  const auto visit = [&](auto&& self, layout::u32 root) -> void {
    for (std::size_t slot = 0; slot < 8; ++slot) {
      const Box box = box_of(p.wide.nodes[root], slot);
      if (box.empty()) continue;
      const layout::u32 child = p.wide.nodes[root].child[slot];
      if ((child & ~KDRAY_WIDE_FIRST_MASK) == KDRAY_INSTANCE_LEAF)
        leaves.push_back({box, child & KDRAY_WIDE_FIRST_MASK});
      else if (!(child & KDRAY_WIDE_LEAF))
        self(self, child);
    }
  };
  visit(visit, 0);
  return leaves;
}

// Visits the leaves below a node of a mesh: their words and boxes, in the mesh's space.
template <class Visit>
void for_each_leaf(const Prepared& p, layout::u32 root, const Visit& visit) {
  for (std::size_t slot = 0; slot < 8; ++slot) {
    const Box box = box_of(p.wide.nodes[root], slot);
    if (box.empty()) continue;
    const layout::u32 child = p.wide.nodes[root].child[slot];
    if (child & KDRAY_WIDE_LEAF)
      visit(child, box);
    else
      for_each_leaf(p, child, visit);
  }
}

dvec3 in_scene(const layout::Instance& instance, const dvec3& point) {
  dvec3 out;
  for (int row = 0; row < 3; ++row) {
    out[row] = instance.place[row];
    for (int k = 0; k < 3; ++k)
      out[row] += static_cast<double>(instance.to_world[row][k]) * (point[k] - instance.mesh_place[k]);
  }
  return out;
}

// What of the box doesn't lie in the leaf's, by more than floats of the transform round.
double sticking_out(const Leaf& leaf, const layout::Instance& instance, const Box& box) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    dvec3 p;
    for (int k = 0; k < 3; ++k) p[k] = corner >> k & 1 ? box.hi[k] : box.lo[k];
    const dvec3 at = in_scene(instance, p);
    for (int k = 0; k < 3; ++k) most = std::max({most, leaf.box.lo[k] - at[k], at[k] - leaf.box.hi[k]});
  }
  return most;
}

// Each leaf below the mesh's root is below just one of the instance's leaves, whose box holds it.
void expect_all_of_each(const Prepared& p) {
  std::map<std::uint32_t, std::multiset<layout::u32>> held;
  for (const Leaf& leaf : leaves_of(p)) {
    const layout::Instance& instance = p.flat.instances[leaf.index];
    ASSERT_LT(instance.whole, p.counts.instances);
    const layout::Instance& whole = p.flat.instances[instance.whole];
    ASSERT_EQ(whole.whole, instance.whole);
    EXPECT_EQ(instance.number, whole.number);
    EXPECT_TRUE(std::ranges::equal(instance.place, whole.place));
    EXPECT_EQ(instance.reach, whole.reach) << "boxes are widened by it, whatever a piece is";
    for_each_leaf(p, instance.root, [&](layout::u32 word, const Box& box) {
      held[instance.whole].insert(word);
      EXPECT_LE(sticking_out(leaf, instance, box), 1e-5 * instance.reach);
    });
  }
  ASSERT_EQ(held.size(), p.counts.instances);
  for (const auto& [index, words] : held) {
    std::multiset<layout::u32> all;
    for_each_leaf(p, p.flat.instances[index].root, [&](layout::u32 word, const Box&) { all.insert(word); });
    EXPECT_EQ(words, all) << "instance " << index;
  }
}

TEST(OpenedInstances, HoldAllOfEachInstanceOnce) {
  for (const bool ground : {false, true}) {
    const Prepared p = prepare(row_of_balls(5, 0.7, ground), {});
    EXPECT_GT(p.flat.instances.size(), 5u * 8);
    EXPECT_EQ(p.counts.instances, 6u);
    expect_all_of_each(p);
  }
}

TEST(OpenedInstances, AreThoseThatLieClose) {
  const Prepared close = prepare(row_of_balls(5, 0.7, false), {});
  std::map<std::uint32_t, int> leaves;
  for (const Leaf& leaf : leaves_of(close)) ++leaves[close.flat.instances[leaf.index].whole];
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_GE(leaves[i], 8) << i;
  EXPECT_EQ(leaves[5], 1) << "far off";
  const Prepared apart = prepare(row_of_balls(5, 4, false), {});
  EXPECT_EQ(apart.flat.instances.size(), 6u);
  const Prepared small = prepare(row_of_balls(5, 0.7, false, 12), {});
  EXPECT_EQ(small.flat.instances.size(), 6u) << "a mesh of leaves can't be opened";
}

TEST(OpenedInstances, AreNoMoreThanMayBe) {
  const Prepared few = prepare(row_of_balls(800, 0.1, false, 3000), {});
  EXPECT_LE(leaves_of(few).size(), flatten::kMostPieces);
  EXPECT_GT(leaves_of(few).size(), 4000u);
  expect_all_of_each(few);
  const Prepared many = prepare(row_of_balls(1100, 0.1, false, 3000), {});
  EXPECT_EQ(many.flat.instances.size(), 1101u);
}

TEST(OpenedInstances, AreWholeAgainWhenClosed) {
  for (const bool ground : {false, true}) {
    Prepared p = prepare(row_of_balls(5, 0.7, ground), {});
    const int stack = p.wide.stack_size;
    flatten::close_instances(p.flat, p.wide);
    EXPECT_EQ(p.flat.instances.size(), 6u);
    EXPECT_EQ(leaves_of(p).size(), 6u);
    EXPECT_GE(p.wide.stack_size, stack);
    expect_all_of_each(p);
  }
}

}  // namespace
}  // namespace kdray::prepare
