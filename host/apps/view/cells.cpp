#include "apps/view/cells.h"

#include <bit>
#include <cstdint>
#include <utility>

namespace kdray::view {

namespace {

struct Cell {
  std::uint32_t node = 0;
  Box box;
};

bool is_leaf(const layout::KdNode& node) {
  return (node.word1 & 3) == KDRAY_NODE_LEAF;
}

// A plane that doesn't part the box leaves it to one of the two.
void split(const Cell& cell, const layout::KdNode& node, std::vector<Cell>& below) {
  const int axis = static_cast<int>(node.word1 & 3);
  const auto plane = std::bit_cast<float>(node.word0);
  Cell low{cell.node + 1, cell.box}, high{node.word1 >> 2, cell.box};
  low.box.hi[axis] = std::min(plane, cell.box.hi[axis]);
  high.box.lo[axis] = std::max(plane, cell.box.lo[axis]);
  for (const Cell& child : {low, high})
    if (!child.box.empty()) below.push_back(child);
}

}  // namespace

std::vector<DBox> cells_of(const prepare::Prepared& scene, int depth) {
  const auto& nodes = scene.flat.nodes;
  if (nodes.size() == 0 || scene.geometry.bounds.empty()) return {};
  std::vector<Cell> level{{0, scene.geometry.bounds}};
  for (int d = 0; d < depth; ++d) {
    std::vector<Cell> below;
    for (const Cell& cell : level) {
      const layout::KdNode& node = nodes.data()[cell.node];
      is_leaf(node) ? below.push_back(cell) : split(cell, node, below);
    }
    if (below.size() > kMostCells) break;
    level = std::move(below);
  }
  std::vector<DBox> boxes;
  const LocalSpace& space = scene.geometry.space;
  for (const Cell& cell : level)
    boxes.push_back({space.world(dvec3(cell.box.lo)), space.world(dvec3(cell.box.hi))});
  return boxes;
}

}  // namespace kdray::view
