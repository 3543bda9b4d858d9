#include "accel/flatten/instance_openings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>

#include "accel/flatten/leaf_block.h"

namespace kdray::flatten {

namespace {

// A piece, or an instance as a whole: part 0 of its mesh.
struct Piece {
  Box box;
  std::uint32_t instance = 0, part = 0;
};

bool meet(const Box& a, const Box& b) {
  return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

// The middle of a box, half as long along each axis.
Box core_of(const Box& box) {
  const vec3 quarter = box.extent() * 0.25f;
  return {box.lo + quarter, box.hi - quarter};
}

// Pieces, and a tree that finds their neighbours.
class Neighbours {
 public:
  explicit Neighbours(std::span<const Piece> pieces) : pieces_(pieces) {
    std::vector<Box> boxes;
    for (const Piece& piece : pieces) boxes.push_back(piece.box);
    nodes_ = build_instance_tree(boxes).nodes;
  }

  // Returns whether a box of another instance reaches into the middle of its box.
  bool near_another(const Piece& piece) const { return meets_another(core_of(piece.box), piece.instance, 0); }

 private:
  bool meets_another(const Box& core, std::uint32_t instance, layout::u32 root) const {
    const layout::WideNode& node = nodes_[root];
    for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
      const Box box = bounds_of_child(node, slot);
      if (box.empty() || !meet(core, box)) continue;
      const layout::u32 child = node.child[slot];
      if (child & KDRAY_WIDE_LEAF ? pieces_[child & KDRAY_WIDE_FIRST_MASK].instance != instance
                                  : meets_another(core, instance, child))
        return true;
    }
    return false;
  }

  std::span<const Piece> pieces_;
  std::vector<layout::WideNode> nodes_;
};

class Opener {
 public:
  Opener(std::span<const scene::Instance> instances, std::span<const MeshForm> meshes,
         const LocalSpace& scene, std::size_t most)
      : instances_(instances), meshes_(meshes), scene_(scene), most_(most) {}

  // Opens what lies close to others, then those of its pieces that still do, until none is left that can be
  // opened, or there would be too many.
  std::vector<Piece> run(std::span<const Box> bounds) {
    for (std::uint32_t i = 0; i < bounds.size(); ++i) pieces_.push_back({bounds[i], i, 0});
    while (open_once()) continue;
    return std::move(pieces_);
  }

 private:
  const MeshForm& mesh_of(const Piece& piece) const { return meshes_[instances_[piece.instance].mesh]; }
  const MeshPart& part_of(const Piece& piece) const { return mesh_of(piece).parts[piece.part]; }

  // Opens the largest first. Returns false where there were none to open.
  bool open_once() {
    std::vector<std::uint32_t> chosen = find_close();
    std::ranges::stable_sort(chosen, std::greater<>(),
                             [&](std::uint32_t i) { return pieces_[i].box.area(); });
    std::size_t n = pieces_.size();
    std::vector<char> opened(n, 0);
    for (const std::uint32_t i : chosen) {
      const std::size_t more = part_of(pieces_[i]).n - 1;
      if (n + more > most_) continue;
      n += more;
      opened[i] = 1;
    }
    if (n == pieces_.size()) return false;
    std::vector<Piece> after;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      opened[i] ? open(pieces_[i], after) : after.push_back(pieces_[i]);
    pieces_ = std::move(after);
    return true;
  }

  std::vector<std::uint32_t> find_close() const {
    const Neighbours neighbours(pieces_);
    std::vector<char> close(pieces_.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces_.size(), 64), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        close[i] = part_of(pieces_[i]).n > 1 && neighbours.near_another(pieces_[i]);
    });
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < close.size(); ++i)
      if (close[i]) found.push_back(i);
    return found;
  }

  void open(const Piece& piece, std::vector<Piece>& into) const {
    const MeshForm& mesh = mesh_of(piece);
    const MeshPart& part = part_of(piece);
    for (std::uint32_t i = part.first; i < part.first + part.n; ++i)
      into.push_back({bounds_of(mesh.parts[i], instances_[piece.instance], mesh, scene_), piece.instance, i});
  }

  std::span<const scene::Instance> instances_;
  std::span<const MeshForm> meshes_;
  const LocalSpace& scene_;
  std::size_t most_;
  std::vector<Piece> pieces_;  // by instance
};

// ---- Closing

// The tree over instances among all nodes.
struct OverInstances {
  layout::u32 first = 0, n = 0;
  int needs = 0;
  std::vector<Box> boxes;  // of each instance, whatever it has been opened into
};

// Whether there is something else than instances below a node.
bool has_primitives(const WideForm& wide, layout::u32 root) {
  const layout::WideNode& node = wide.nodes[root];
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    const layout::u32 child = node.child[slot];
    if (bounds_of_child(node, slot).empty() || is_instance(child)) continue;
    if ((child & KDRAY_WIDE_LEAF) || has_primitives(wide, child)) return true;
  }
  return false;
}

StackNeeds visit(const FlatScene& flat, const WideForm& wide, layout::u32 root, OverInstances& over) {
  ++over.n;
  const layout::WideNode& node = wide.nodes[root];
  std::array<StackNeeds, kWidth> needs{};
  std::array<const StackNeeds*, kWidth> below{};
  std::uint32_t n = 0;
  for (std::uint32_t slot = 0; slot < kWidth; ++slot) {
    below[slot] = &needs[slot];
    const Box box = bounds_of_child(node, slot);
    if (box.empty()) continue;
    ++n;
    const layout::u32 child = node.child[slot];
    if (is_instance(child))
      over.boxes[flat.instances[child & KDRAY_WIDE_FIRST_MASK].whole].grow(box);
    else
      needs[slot] = visit(flat, wide, child, over);
  }
  return needs_of_node(node.order, n, below);
}

int most_of(const StackNeeds& needs) {
  return *std::max_element(needs.begin(), needs.end());
}

// Finds the tree over instances. Where the scene has primitives of its own, the root has two children: these,
// and that tree.
OverInstances find_tree(const FlatScene& flat, const WideForm& wide, std::size_t n_wholes) {
  OverInstances over;
  over.boxes.resize(n_wholes);
  if (has_primitives(wide, 0)) over.first = wide.nodes[0].child[1];
  over.needs = most_of(visit(flat, wide, over.first, over));
  return over;
}

}  // namespace

InstanceLeaves open_instances(PlacedInstances& placed, std::span<const scene::Instance> instances,
                              std::span<const MeshForm> meshes, const LocalSpace& scene, std::size_t most) {
  const std::size_t n = instances.size();
  InstanceLeaves leaves{placed.bounds, {}};
  if (n < 2 || n > most / kWidth) return leaves;  // with so many, each would get a few pieces at most
  const std::vector<Piece> pieces = Opener(instances, meshes, scene, most).run(placed.bounds);
  if (pieces.size() == n) return leaves;
  leaves = {};
  std::vector<layout::Instance> all(placed.instances.begin(), placed.instances.end());
  for (const Piece& piece : pieces) {
    leaves.boxes.push_back(piece.box);
    leaves.instances.push_back(piece.part == 0 ? piece.instance : static_cast<std::uint32_t>(all.size()));
    if (piece.part == 0) continue;
    all.push_back(placed.instances[piece.instance]);
    all.back().root = meshes[instances[piece.instance].mesh].parts[piece.part].root;
  }
  placed.instances = Array<layout::Instance>(all.size());
  std::ranges::copy(all, placed.instances.begin());
  return leaves;
}

void close_instances(FlatScene& flat, WideForm& wide) {
  const auto is_whole = [&](std::size_t i) { return flat.instances[i].whole == i; };
  std::size_t n = 0;
  while (n < flat.instances.size() && is_whole(n)) ++n;
  if (n == flat.instances.size()) return;
  const OverInstances before = find_tree(flat, wide, n);
  const InstanceTree tree = build_instance_tree(before.boxes);
  const auto n_now = static_cast<layout::u32>(tree.nodes.size());
  const layout::u32 behind = before.first + before.n;  // what lies there moves; a sum may wrap around
  Array<layout::WideNode> nodes(wide.nodes.size() - before.n + n_now);
  const auto moved = [](layout::WideNode node, layout::u32 by) {
    for (layout::u32& child : node.child)
      if (!(child & KDRAY_WIDE_LEAF)) child += by;
    return node;
  };
  std::copy(wide.nodes.begin(), wide.nodes.begin() + before.first, nodes.begin());
  for (layout::u32 i = 0; i < n_now; ++i) nodes[before.first + i] = moved(tree.nodes[i], before.first);
  for (std::size_t i = behind; i < wide.nodes.size(); ++i)
    nodes[i - before.n + n_now] = moved(wide.nodes[i], n_now - before.n);
  wide.nodes = std::move(nodes);
  wide.stack_size += std::max(0, most_of(tree.needs) - before.needs);
  Array<layout::Instance> wholes(n);
  for (std::size_t i = 0; i < n; ++i) {
    wholes[i] = flat.instances[i];
    wholes[i].root += n_now - before.n;
  }
  flat.instances = std::move(wholes);
}

}  // namespace kdray::flatten
