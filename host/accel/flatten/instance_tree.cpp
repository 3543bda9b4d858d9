#include "accel/flatten/instance_openings.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "accel/flatten/collapse.h"
#include "accel/flatten/leaf_block.h"
#include "layout/instances.layout.h"

namespace kdray::flatten {

namespace {

constexpr int kBins = 16;

double area_of(const Box& box) {
  if (box.empty()) return 0;
  const dvec3 e(box.extent());
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

struct Part {
  std::size_t first = 0, end = 0;  // of the order
  Box box;

  std::size_t size() const { return end - first; }
};

class Builder {
 public:
  Builder(std::span<const Box> boxes, std::span<const std::uint32_t> instances)
      : boxes_(boxes), instances_(instances), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
  }

  InstanceTree build() {
    tree_.needs = add_node(part_of(0, order_.size()));
    return std::move(tree_);
  }

 private:
  float middle(std::uint32_t i, int axis) const {
    return 0.5f * boxes_[i].lo[axis] + 0.5f * boxes_[i].hi[axis];
  }

  std::uint32_t instance_of(std::uint32_t i) const { return instances_.empty() ? i : instances_[i]; }

  Part part_of(std::size_t first, std::size_t end) const {
    Part part{first, end, {}};
    for (std::size_t i = first; i < end; ++i) part.box.grow(boxes_[order_[i]]);
    return part;
  }

  // Adds a node: a part of one box is an instance, any other part becomes a node.
  StackNeeds add_node(const Part& whole) {
    std::array<Part, kWidth> parts{whole};
    std::uint32_t n = 1;
    while (n < kWidth) {
      const std::uint32_t dearest = dearest_of({parts.data(), n});
      if (parts[dearest].size() < 2) break;
      const std::size_t at = divide(parts[dearest]);
      parts[n++] = part_of(at, parts[dearest].end);
      parts[dearest] = part_of(parts[dearest].first, at);
    }
    const std::size_t self = tree_.nodes.size();
    tree_.nodes.emplace_back();
    std::array<Box, kWidth> boxes;
    std::array<layout::u32, kWidth> children{};
    std::array<StackNeeds, kWidth> needs{};
    std::array<const StackNeeds*, kWidth> below{};
    for (std::uint32_t i = 0; i < n; ++i) {
      boxes[i] = parts[i].box;
      below[i] = &needs[i];
      if (parts[i].size() == 1) {
        children[i] = KDRAY_INSTANCE_LEAF | instance_of(order_[parts[i].first]);
      } else {
        children[i] = static_cast<layout::u32>(tree_.nodes.size());
        needs[i] = add_node(parts[i]);
      }
    }
    tree_.nodes[self] = node_of({boxes.data(), n}, {children.data(), n});
    return needs_of_node(tree_.nodes[self].order, n, below);
  }

  static std::uint32_t dearest_of(std::span<const Part> parts) {
    std::uint32_t dearest = 0;
    double most = -1;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
      const double cost =
          parts[i].size() < 2 ? -0.5 : area_of(parts[i].box) * static_cast<double>(parts[i].size());
      if (cost > most) most = cost, dearest = i;
    }
    return dearest;
  }

  // Puts the part in order and returns where its second half begins.
  std::size_t divide(const Part& part) {
    Box middles;
    for (std::size_t i = part.first; i < part.end; ++i)
      middles.grow(vec3(middle(order_[i], 0), middle(order_[i], 1), middle(order_[i], 2)));
    const vec3 extent = middles.extent();
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const std::size_t half = part.first + part.size() / 2;
    if (!(extent[axis] > 0)) return half;  // all in one place: as they come
    const float lo = middles.lo[axis], scale = kBins / extent[axis];
    const auto bin_of = [&](std::uint32_t i) {
      return std::clamp(static_cast<int>((middle(i, axis) - lo) * scale), 0, kBins - 1);
    };
    const int plane = best_plane(part, bin_of);
    const auto at = order_.begin() + static_cast<std::ptrdiff_t>(part.first),
               end = order_.begin() + static_cast<std::ptrdiff_t>(part.end);
    const auto second = std::stable_partition(at, end, [&](std::uint32_t i) { return bin_of(i) < plane; });
    const auto place = static_cast<std::size_t>(second - order_.begin());
    return place == part.first || place == part.end ? half : place;
  }

  template <class BinOf>
  int best_plane(const Part& part, const BinOf& bin_of) const {
    std::array<Box, kBins> boxes;
    std::array<std::size_t, kBins> counts{};
    for (std::size_t i = part.first; i < part.end; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(order_[i]));
      boxes[bin].grow(boxes_[order_[i]]);
      ++counts[bin];
    }
    std::array<double, kBins> above{};  // the cost of the bins from each on
    Box box;
    std::size_t n = 0;
    for (std::size_t bin = kBins; bin-- > 1;) {
      box.grow(boxes[bin]);
      n += counts[bin];
      above[bin] = area_of(box) * static_cast<double>(n);
    }
    Box below;
    std::size_t n_below = 0;
    int best = kBins / 2;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t bin = 1; bin < kBins; ++bin) {
      below.grow(boxes[bin - 1]);
      n_below += counts[bin - 1];
      const double cost = area_of(below) * static_cast<double>(n_below) + above[bin];
      if (n_below > 0 && n_below < part.size() && cost < least) least = cost, best = static_cast<int>(bin);
    }
    return best;
  }

  std::span<const Box> boxes_;
  std::span<const std::uint32_t> instances_;
  std::vector<std::uint32_t> order_;
  InstanceTree tree_;
};

}  // namespace

InstanceTree build_instance_tree(std::span<const Box> boxes, std::span<const std::uint32_t> instances) {
  return Builder(boxes, instances).build();
}

layout::WideNode node_of(std::span<const Box> boxes, std::span<const layout::u32> children) {
  layout::WideNode node{};
  const Box none;  // lo = inf, hi = -inf
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    set_bounds(node, slot, slot < boxes.size() ? boxes[slot] : none);
    node.child[slot] = slot < children.size() ? children[slot] : 0;
  }
  layout::u32 as_they_come = 0;
  for (layout::u32 slot = 0; slot < kWidth; ++slot) as_they_come |= slot << (3 * (kWidth - 1 - slot));
  std::fill(std::begin(node.order), std::end(node.order), as_they_come);
  order_anew(node, static_cast<std::uint32_t>(boxes.size()));
  return node;
}

}  // namespace kdray::flatten
