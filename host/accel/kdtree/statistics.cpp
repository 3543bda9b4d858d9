#include "accel/kdtree/statistics.h"

#include <algorithm>

#include "accel/kdtree/sah.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kSizeClasses = 33;  // 0 to 31 references, and 32 or more

struct Visit {
  std::uint32_t node;
  int depth;
  Bounds cell;
};

void count_cell(std::uint32_t n, int depth, Statistics& s) {
  ++s.leaves;
  s.empty_leaves += n == 0;
  s.references += n;
  ++s.leaves_by_size[std::min<std::size_t>(n, kSizeClasses - 1)];
  s.largest_leaf = std::max(s.largest_leaf, n);
  s.max_depth = std::max(s.max_depth, depth);
  s.mean_leaf_depth += depth;
}

// Returns the expected cost of all groups of a cell, or of the one leaf that it is.
double groups_cost(const Tree& tree, std::uint32_t cell, double root_area, double chance_of_cell,
                   const BuildConfig& config, Statistics& s) {
  double cost = 0;
  for (std::uint32_t i = cell, last = last_leaf(tree, cell); i <= last; ++i) {
    const Bounds contents = bounds_from(tree.contents[i]);
    const double chance =
        contents.empty() ? 0 : (root_area > 0 ? half_area(contents) / root_area : chance_of_cell);
    const Node& node = tree.nodes[i];
    cost += chance *
            (node.is_leaf() ? config.cost_intersect * LeafCost(config)(node.right) : config.cost_traverse);
    s.groups += node.is_leaf() && last > cell ? 1 : 0;
  }
  return cost;
}

}  // namespace

Statistics measure(const Tree& tree, const scene::Geometry& geometry, const BuildConfig& config) {
  Statistics s;
  s.leaves_by_size.assign(kSizeClasses, 0);
  if (tree.nodes.empty()) return s;
  const Bounds root = bounds_from(tree.bounds);
  const double root_area = root.empty() ? 0 : half_area(root);
  std::vector<Visit> stack{{0, 0, root}};
  while (!stack.empty()) {
    const Visit v = stack.back();
    stack.pop_back();
    const Node& node = tree.nodes[v.node];
    // The chance that a ray through the root's cell meets this one; a root without area is met at the root
    // only.
    const double chance = root_area > 0 ? half_area(v.cell) / root_area : (v.depth == 0 ? 1.0 : 0.0);
    const Bounds contents = bounds_from(tree.contents[v.node]);
    const double tight_chance =
        contents.empty() ? 0 : (root_area > 0 ? half_area(contents) / root_area : chance);
    if (node.is_leaf() || node.has_groups()) {
      const std::uint32_t n = refs_of_cell(tree, v.node).n;
      count_cell(n, v.depth, s);
      s.sah_cost += chance * config.cost_intersect * LeafCost(config)(n);
      s.tight_cost += groups_cost(tree, v.node, root_area, tight_chance, config, s);
      continue;
    }
    ++s.inner_nodes;
    s.sah_cost += chance * config.cost_traverse;
    s.tight_cost += tight_chance * config.cost_traverse;
    const int axis = static_cast<int>(node.axis);
    stack.push_back({node.right, v.depth + 1, above(v.cell, axis, node.split)});
    stack.push_back({node.left, v.depth + 1, below(v.cell, axis, node.split)});
  }
  s.mean_leaf_depth /= static_cast<double>(s.leaves);
  if (geometry.size() > 0)
    s.duplication = static_cast<double>(s.references) / static_cast<double>(geometry.size());
  return s;
}

}  // namespace kdray::kdtree
