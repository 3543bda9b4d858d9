// What    The parts of a divided scene with instances: each instance lies in one part, by its number in the
//         whole, with all of its mesh; nothing of a mesh counts as shared; an instance is held by no second
//         part, however much is replicated.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "accel/flatten/instance_openings.h"
#include "accel/prepare/prepared.h"
#include "engine/odprt/assign.h"
#include "engine/odprt/division.h"
#include "engine/odprt/subtrees.h"
#include "pictures/scenes.h"

namespace kdray::test {
namespace {

using odprt::blocks_of, odprt::kBlockRows;

// The primitives below a child of a node, as kind and number, one for each place in a block.
void collect(const flatten::FlatScene& scene, const flatten::WideForm& form, layout::u32 child,
             std::vector<std::pair<std::uint32_t, std::uint32_t>>& found) {
  if (!(child & KDRAY_WIDE_LEAF)) {
    for (std::uint32_t slot = 0; slot < 8; ++slot)
      if (!odprt::bounds_of_child(form.nodes[child], slot).empty())
        collect(scene, form, form.nodes[child].child[slot], found);
    return;
  }
  ASSERT_FALSE(odprt::is_instance(child)) << "there are no instances in a mesh";
  const std::uint32_t kind = flatten::leaf_kind(child);
  const auto width = static_cast<std::size_t>(form.block);
  const std::size_t words = kBlockRows[kind] * width;
  const layout::u32* block = blocks_of(form, kind).data() + (child & KDRAY_WIDE_FIRST_MASK) * words;
  for (std::uint32_t b = 0; b < odprt::leaf_blocks(form, child); ++b, block += words)
    for (std::size_t lane = 0; lane < width; ++lane) {
      const layout::u32 index = block[(kBlockRows[kind] - 1) * width + lane];
      const auto number = primitives::with_kind(
          kind, [&](auto k) { return decltype(k)::of(scene)[index & ~KDRAY_WIDE_LAST].number; });
      found.emplace_back(kind, number);
      if (index & KDRAY_WIDE_LAST) break;
    }
}

auto primitives_of(const flatten::FlatScene& scene, const flatten::WideForm& form,
                   const layout::Instance& instance) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  collect(scene, form, instance.root, found);
  return found;
}

// As what is divided is: an instance that has been opened is whole again.
prepare::Prepared closed(prepare::Prepared scene) {
  flatten::close_instances(scene.flat, scene.wide);
  return scene;
}

class InstancedParts : public testing::Test {
 protected:
  const prepare::Prepared scene = closed(prepare::prepare(instanced(), TreeOptions()));
  const odprt::Cut cut = odprt::cut(scene.flat, scene.wide, 48);

  std::vector<double> costs() const {
    std::vector<double> all;
    for (const odprt::Subtree& s : cut.subtrees) all.push_back(s.cost);
    return all;
  }
};

TEST_F(InstancedParts, HoldEachInstanceOnceWithItsWholeMesh) {
  for (const std::uint32_t n_parts : {2u, 3u, 7u}) {
    const odprt::Division division = odprt::divide(scene.flat, scene.wide, cut, costs(), {n_parts});
    std::map<std::uint32_t, int> times;
    for (const odprt::Part& part : division.parts) {
      std::uint32_t next = 0;
      for (const layout::Instance& instance : part.flat.instances) {
        EXPECT_EQ(&part.flat.instances[instance.whole], &instance);
        ++times[instance.number];
        EXPECT_GE(instance.number, next) << "the order of the whole";
        next = instance.number + 1;
        const layout::Instance& whole = scene.flat.instances[instance.number];
        EXPECT_EQ(primitives_of(part.flat, part.wide, instance),
                  primitives_of(scene.flat, scene.wide, whole));
        EXPECT_TRUE(std::equal(std::begin(instance.place), std::end(instance.place), whole.place));
      }
      EXPECT_EQ(part.wide.widen, scene.wide.widen);
    }
    EXPECT_EQ(times.size(), scene.flat.instances.size());
    for (const auto& [number, n] : times) EXPECT_EQ(n, 1) << "instance " << number;
  }
}

// The floor alone is the scene's own: two triangles.
TEST_F(InstancedParts, ShareNothingOfMeshes) {
  const odprt::Division division = odprt::divide(scene.flat, scene.wide, cut, costs(), {4});
  for (const odprt::Part& part : division.parts) EXPECT_LE(part.n_shared, 2u);
}

TEST_F(InstancedParts, AreNotReplicated) {
  const auto part_of = odprt::assign(cut, costs(), {2, 0.9, 0.9});
  std::size_t placed = 0;
  for (std::size_t i = 0; i < part_of.size(); ++i) {
    if (!cut.subtrees[i].placed) continue;
    ++placed;
    EXPECT_NE(part_of[i], odprt::kEveryPart);
  }
  EXPECT_GT(placed, 8u);
  for (const odprt::Subtree& s : cut.subtrees) {
    EXPECT_GT(s.cost, 0);
    EXPECT_GT(s.bytes, 0u);
  }
}

}  // namespace
}  // namespace kdray::test
