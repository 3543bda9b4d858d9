#include "engine/odprt/subtrees.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <list>
#include <queue>
#include <unordered_map>

#include "layout/instances.layout.h"
#include "layout/primitives.layout.h"

namespace kdray::odprt {

namespace {

// The heuristic's units: a node costs 1, a block of primitives 2 (host/accel/kdtree).
constexpr double kNodeCost = 1, kBlockCost = 2;

// What a subtree takes: surface times cost, and bytes.
struct Load {
  double cost = 0;
  std::uint64_t bytes = 0;
  bool placed = false;  // has instances

  void add(const Load& o) {
    cost += o.cost;
    bytes += o.bytes;
    placed = placed || o.placed;
  }
};

class Loads {
 public:
  Loads(const flatten::FlatScene& scene, const flatten::WideForm& form)
      : scene_(scene), form_(form), nodes_(form.nodes.size()) {
    for (const layout::Instance& instance : scene.instances) ++n_placed_[instance.root];
    // A smooth triangle has its normals beside it, a textured one what is at its corners.
    const std::uint64_t beside =
        scene.normals.bytes() + scene.texcoords.bytes() + scene.corner_colors.bytes();
    const std::uint64_t each = scene.triangles.empty() ? 0 : beside / scene.triangles.size();
    primitives::for_each_kind(
        [this](auto kind) { primitive_bytes_[kind.kNumber] = sizeof(typename decltype(kind)::Layout); });
    primitive_bytes_[KDRAY_KIND_TRIANGLE] += each;
    tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) { nodes_[i] = own(form_.nodes[i]); });
    // Children come behind their parents, meshes behind their instances.
    for (std::size_t i = nodes_.size(); i-- > 0;)
      for (std::uint32_t slot = 0; slot < 8; ++slot) {
        const layout::u32 child = form_.nodes[i].child[slot];
        const Box bounds = bounds_of_child(form_.nodes[i], slot);
        if (bounds.empty()) continue;
        if (!(child & KDRAY_WIDE_LEAF))
          nodes_[i].add(nodes_[child]);
        else if (is_instance(child))
          nodes_[i].add(of_instance(child, bounds));
      }
  }

  Load of(layout::u32 child, const Box& bounds) const {
    if (child & KDRAY_WIDE_LEAF)
      return is_instance(child) ? of_instance(child, bounds) : of_leaf(child, bounds);
    Load load = nodes_[child];
    load.cost += kNodeCost * static_cast<double>(bounds.area());
    return load;
  }

 private:
  Load of_leaf(layout::u32 leaf, const Box& bounds) const {
    const std::uint32_t kind = flatten::leaf_kind(leaf), n = leaf_blocks(form_, leaf);
    const auto lanes = n * static_cast<std::uint64_t>(form_.block);
    return {kBlockCost * n * static_cast<double>(bounds.area()),
            lanes * (kBlockRows[kind] * sizeof(float) + primitive_bytes_[kind])};
  }

  // What a ray that meets the mesh's bounds is expected to cost there, it costs one that meets the
  // instance's.
  Load of_instance(layout::u32 leaf, const Box& bounds) const {
    const layout::u32 root = scene_.instances[leaf & KDRAY_WIDE_FIRST_MASK].root;
    Box of_mesh;
    for (std::uint32_t slot = 0; slot < 8; ++slot) of_mesh.grow(bounds_of_child(form_.nodes[root], slot));
    const Load& mesh = nodes_[root];
    const auto area = static_cast<double>(of_mesh.area());
    const double within = area > 0 ? mesh.cost / area : 0;
    return {(kNodeCost + within) * static_cast<double>(bounds.area()),
            sizeof(layout::Instance) + mesh.bytes / n_placed_.at(root), true};
  }

  // A node's leaves but for instances, and that it costs something to come to its inner children.
  Load own(const layout::WideNode& node) const {
    Load load{0, sizeof(layout::WideNode)};
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      const Box bounds = bounds_of_child(node, slot);
      if (bounds.empty() || is_instance(node.child[slot])) continue;
      if (node.child[slot] & KDRAY_WIDE_LEAF)
        load.add(of_leaf(node.child[slot], bounds));
      else
        load.cost += kNodeCost * static_cast<double>(bounds.area());
    }
    return load;
  }

  const flatten::FlatScene& scene_;
  const flatten::WideForm& form_;
  std::unordered_map<layout::u32, std::uint64_t> n_placed_;  // by their mesh's root
  std::vector<Load> nodes_;
  std::array<std::uint64_t, kKinds> primitive_bytes_{};
};

class Cutter {
 public:
  Cutter(const flatten::FlatScene& scene, const flatten::WideForm& form) : form_(form), loads_(scene, form) {}

  Cut run(std::size_t n) {
    open(subtrees_.end(), 0);
    while (subtrees_.size() < n && !open_.empty()) {
      const Place place = open_.top().second;
      open_.pop();
      const Item item = *place;
      const auto index = static_cast<std::int32_t>(cut_.top.size());
      cut_.top[item.parent].below[item.slot] = index;
      open(subtrees_.erase(place), item.subtree.child);
    }
    for (const Item& item : subtrees_) {
      cut_.top[item.parent].below[item.slot] = -1 - static_cast<std::int32_t>(cut_.subtrees.size());
      cut_.subtrees.push_back(item.subtree);
    }
    return std::move(cut_);
  }

 private:
  struct Item {
    Subtree subtree;
    std::uint32_t parent, slot;  // in cut_.top
  };
  using Place = std::list<Item>::iterator;

  // Puts a node's children before `place`, in the tree's order: front to back for rays with positive
  // directions.
  void open(Place place, std::uint32_t index) {
    const layout::WideNode& node = form_.nodes[index];
    const auto parent = static_cast<std::uint32_t>(cut_.top.size());
    cut_.top.push_back({index, {}});
    cut_.top.back().below.fill(OpenedNode::kEmpty);
    for (std::uint32_t k = 8; k-- > 0;) {
      const std::uint32_t slot = node.order[0] >> (3 * k) & 7u;
      const Box bounds = bounds_of_child(node, slot);
      if (bounds.empty()) continue;
      const Place child = subtrees_.insert(place, {subtree(node.child[slot], bounds), parent, slot});
      if (!(node.child[slot] & KDRAY_WIDE_LEAF)) open_.emplace(child->subtree.cost, child);
    }
  }

  Subtree subtree(layout::u32 child, const Box& bounds) const {
    const Load load = loads_.of(child, bounds);
    const auto area = static_cast<double>(bounds.area());
    return {bounds, load.cost, area > 0 ? load.cost / area : kNodeCost, load.bytes, child, load.placed};
  }

  struct Cheaper {
    template <class T>
    bool operator()(const T& a, const T& b) const {
      return a.first < b.first;
    }
  };

  const flatten::WideForm& form_;
  const Loads loads_;
  std::list<Item> subtrees_;
  std::priority_queue<std::pair<double, Place>, std::vector<std::pair<double, Place>>, Cheaper> open_;
  Cut cut_;
};

}  // namespace

std::uint32_t leaf_blocks(const flatten::WideForm& form, layout::u32 leaf) {
  if (is_instance(leaf)) return 1;
  const std::uint32_t kind = flatten::leaf_kind(leaf);
  const std::size_t words = kBlockRows[kind] * static_cast<std::size_t>(form.block);
  const layout::u32* block = blocks_of(form, kind).data() + (leaf & KDRAY_WIDE_FIRST_MASK) * words;
  std::uint32_t n = 1;
  for (; !(block[words - 1] & KDRAY_WIDE_LAST); block += words) ++n;
  return n;
}

Cut cut(const flatten::FlatScene& scene, const flatten::WideForm& form, std::size_t n) {
  if (form.nodes.empty()) return {};
  return Cutter(scene, form).run(n);
}

namespace {

float distance_to(const Box& box, const vec3& point) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) {
    const float outside = std::max({box.lo[k] - point[k], point[k] - box.hi[k], 0.0f});
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

// What lies in a child's bounds is nowhere nearer than these are.
void Locator::look_below(std::size_t opened, const vec3& point, Nearest& nearest) const {
  const OpenedNode& node = cut_.top[opened];
  for (std::uint32_t slot = 0; slot < 8 && nearest.distance > 0; ++slot) {
    const std::int32_t below = node.below[slot];
    if (below == OpenedNode::kEmpty) continue;
    const float distance = distance_to(bounds_of_child(form_.nodes[node.node], slot), point);
    if (distance >= nearest.distance) continue;
    if (below >= 0)
      look_below(static_cast<std::size_t>(below), point, nearest);
    else
      nearest = {distance, static_cast<std::uint32_t>(-1 - below)};
  }
}

std::optional<std::uint32_t> Locator::find(const vec3& point) const {
  Nearest nearest{std::numeric_limits<float>::infinity()};
  if (!cut_.top.empty()) look_below(0, point, nearest);
  return nearest.subtree;
}

}  // namespace kdray::odprt
