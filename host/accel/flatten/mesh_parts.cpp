#include "accel/flatten/mesh_parts.h"

#include <algorithm>

#include "accel/flatten/leaf_block.h"
#include "layout/wide.layout.h"

namespace kdray::flatten {

namespace {

constexpr int kLevels = 3;  // 8, 64, 512 parts

struct Child {
  Box box;
  layout::u32 word;
};

std::vector<Child> children_of(const WideForm& mesh, layout::u32 root) {
  const layout::WideNode& node = mesh.nodes[root];
  std::vector<Child> children;
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    const Box box = bounds_of_child(node, slot);
    if (!box.empty()) children.push_back({box, node.child[slot]});
  }
  return children;
}

// The boxes of a node's children and their children, which cover all that is below it and hug what is turned
// as its own box would not.
std::vector<Box> boxes_below(const WideForm& mesh, layout::u32 root) {
  std::vector<Box> boxes;
  for (const Child& child : children_of(mesh, root)) {
    if (is_leaf(child.word)) {
      boxes.push_back(child.box);
      continue;
    }
    for (const Child& below : children_of(mesh, child.word)) boxes.push_back(below.box);
  }
  return boxes;
}

bool all_nodes(const std::vector<Child>& children) {
  return std::ranges::none_of(children, [](const Child& c) { return is_leaf(c.word); });
}

}  // namespace

std::vector<MeshPart> parts_of(const WideForm& mesh) {
  std::vector<MeshPart> parts{{boxes_below(mesh, 0)}};
  for (std::size_t level = 0, begin = 0; level < kLevels; ++level) {
    const std::size_t end = parts.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::vector<Child> children = children_of(mesh, parts[i].root);
      if (!all_nodes(children)) continue;
      parts[i].first = static_cast<std::uint32_t>(parts.size());
      parts[i].n = static_cast<std::uint32_t>(children.size());
      for (const Child& child : children) parts.push_back({boxes_below(mesh, child.word), child.word});
    }
    begin = end;
  }
  return parts;
}

}  // namespace kdray::flatten
