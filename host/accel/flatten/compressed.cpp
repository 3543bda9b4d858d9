#include "accel/flatten/compressed.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "accel/flatten/leaf_block.h"
#include "layout/instances.layout.h"

namespace kdray::flatten {

namespace {

constexpr int kSteps = 255;

// Whether a slot has a child. In meshes appended behind others an empty slot's word isn't 0, but its
// box is empty.
bool holds_child(const layout::WideNode& node, std::uint32_t slot) {
  return node.child[slot] != 0 && node.bounds[0][0][slot] <= node.bounds[0][1][slot];
}

// Returns the least exponent with which all of the extent is within reach; a float holds its power of two.
int exponent_for(double extent) {
  int exponent = 0;
  std::frexp(extent / kSteps, &exponent);  // extent <= kSteps * 2^exponent
  return std::clamp(exponent, -126, 127);
}

layout::u8 steps(double count) {
  return static_cast<layout::u8>(std::clamp(count, 0.0, double{kSteps}));
}

void compress_axis(const layout::WideNode& node, std::size_t axis, layout::CompressedNode& out) {
  const float* const lo = node.bounds[axis][0];
  const float* const hi = node.bounds[axis][1];
  float least = std::numeric_limits<float>::infinity(), most = -least;
  for (std::uint32_t slot = 0; slot < kWidth; ++slot)
    if (holds_child(node, slot)) least = std::min(least, lo[slot]), most = std::max(most, hi[slot]);
  if (!(least <= most)) return;
  const int exponent = exponent_for(double{most} - double{least});
  out.origin[axis] = least;
  out.scales |= static_cast<layout::u32>(exponent + 127) << (8 * axis);
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    if (!holds_child(node, slot)) continue;
    out.bounds[axis][0][slot] = steps(std::floor(std::ldexp(double{lo[slot]} - double{least}, -exponent)));
    out.bounds[axis][1][slot] = steps(std::ceil(std::ldexp(double{hi[slot]} - double{least}, -exponent)));
  }
}

// The most nodes on a way down from each node, found once. Recursion is no deeper than the tree.
class Levels {
 public:
  explicit Levels(const Array<layout::WideNode>& nodes) : nodes_(nodes), found_(nodes.size()) {}

  int below(std::size_t index) {
    if (found_[index] > 0) return found_[index];
    int most = 0;
    for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
      if (!holds_child(nodes_[index], slot)) continue;
      const layout::u32 child = nodes_[index].child[slot];
      if ((child & ~KDRAY_WIDE_FIRST_MASK) == KDRAY_INSTANCE_LEAF) instances_ = true;
      if (!(child & KDRAY_WIDE_LEAF)) most = std::max(most, below(child));
    }
    return found_[index] = most + 1;
  }

  bool met_instances() const { return instances_; }

 private:
  const Array<layout::WideNode>& nodes_;
  std::vector<int> found_;
  bool instances_ = false;
};

}  // namespace

int most_levels(const Array<layout::WideNode>& nodes) {
  Levels levels(nodes);
  int most = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) most = std::max(most, levels.below(i));
  return levels.met_instances() ? 2 * most : most;
}

layout::CompressedNode compressed(const layout::WideNode& node) {
  layout::CompressedNode out{};
  for (std::size_t axis = 0; axis < 3; ++axis) compress_axis(node, axis, out);
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    out.child[slot] = node.child[slot];
    out.scales |= layout::u32{holds_child(node, slot)} << (24 + slot);
  }
  return out;
}

Array<layout::CompressedNode> compressed(const Array<layout::WideNode>& nodes) {
  Array<layout::CompressedNode> made(nodes.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) { made[i] = compressed(nodes[i]); });
  return made;
}

}  // namespace kdray::flatten
