#include "engine/odprt/division.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "engine/odprt/assign.h"
#include "engine/odprt/subtrees.h"
#include "layout/instances.layout.h"
#include "layout/primitives.layout.h"
#include "layout/wide.layout.h"

namespace kdray::odprt {

namespace {

// For each primitive how many parts hold it.
struct Holders {
  std::array<std::vector<std::uint32_t>, kKinds> of;

  explicit Holders(const flatten::FlatScene& scene) {
    primitives::for_each_kind([&](auto kind) { of[kind.kNumber].resize(decltype(kind)::of(scene).size()); });
  }
  void add(std::uint32_t kind, std::uint32_t index) {
    std::atomic_ref(of[kind][index]).fetch_add(1, std::memory_order_relaxed);
  }
};

struct Sizes {
  std::size_t nodes = 0;
  std::array<std::size_t, kKinds> blocks{};
  std::array<std::vector<std::uint32_t>, kKinds> primitives;  // ascending
  std::vector<std::uint32_t> instances;                       // by number
  std::vector<layout::u32> roots;                             // of their meshes
  std::array<std::uint32_t, kKinds> meshes;                   // the first primitive that is in one of these

  Sizes() { meshes.fill(std::numeric_limits<std::uint32_t>::max()); }
};

// Goes through what a part keeps of the tree.
class PartWalk {
 public:
  PartWalk(const flatten::WideForm& form, const Cut& cut, std::span<const std::uint32_t> part_of,
           std::uint32_t part)
      : form_(form), cut_(cut), part_of_(part_of), part_(part), holds_(cut.top.size()) {
    // Opened nodes come behind those that they were opened from.
    for (std::size_t i = cut.top.size(); i-- > 0;)
      for (const std::int32_t below : cut.top[i].below) holds_[i] = holds_[i] || holds(below);
  }

  // What becomes of an opened node's child.
  bool holds(std::int32_t below) const {
    if (below == OpenedNode::kEmpty) return false;
    if (below >= 0) return holds_[static_cast<std::size_t>(below)];
    const std::uint32_t part = part_of_[static_cast<std::size_t>(-1 - below)];
    return part == part_ || part == kEveryPart;
  }

  const flatten::WideForm& form() const { return form_; }
  const Cut& cut() const { return cut_; }

 private:
  const flatten::WideForm& form_;
  const Cut& cut_;
  std::span<const std::uint32_t> part_of_;
  std::uint32_t part_;
  std::vector<char> holds_;
};

bool is_empty(const layout::WideNode& node, std::uint32_t slot) {
  return bounds_of_child(node, slot).empty();
}

// First pass: how much there is, and who holds which primitives.
class Counting {
 public:
  Counting(const flatten::FlatScene& scene, const PartWalk& walk, Holders& holders)
      : scene_(scene), walk_(walk), holders_(holders) {
    for (std::uint32_t kind = 0; kind < kKinds; ++kind) held_[kind].resize(holders.of[kind].size());
    count_opened(0);
    std::sort(sizes_.instances.begin(), sizes_.instances.end());
    count_meshes();
    list_primitives();
  }

  const Sizes& sizes() const { return sizes_; }

 private:
  void count_opened(std::size_t i) {
    const OpenedNode& opened = walk_.cut().top[i];
    const layout::WideNode& node = walk_.form().nodes[opened.node];
    ++sizes_.nodes;
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      if (!walk_.holds(opened.below[slot])) continue;
      if (opened.below[slot] >= 0)
        count_opened(static_cast<std::size_t>(opened.below[slot]));
      else
        count_child(node.child[slot]);
    }
  }

  void count_child(layout::u32 child) {
    if (child & KDRAY_WIDE_LEAF) {
      count_leaf(child);
      return;
    }
    ++sizes_.nodes;
    const layout::WideNode& node = walk_.form().nodes[child];
    for (std::uint32_t slot = 0; slot < 8; ++slot)
      if (!is_empty(node, slot)) count_child(node.child[slot]);
  }

  // Each that there is an instance of, once.
  void count_meshes() {
    std::unordered_set<layout::u32> known;
    for (const std::uint32_t i : sizes_.instances)
      if (const layout::u32 root = scene_.instances[i].root; known.insert(root).second)
        sizes_.roots.push_back(root);
    in_mesh_ = true;
    for (const layout::u32 root : sizes_.roots) count_child(root);
  }

  void count_leaf(layout::u32 leaf) {
    if (is_instance(leaf)) {
      sizes_.instances.push_back(leaf & KDRAY_WIDE_FIRST_MASK);
      return;
    }
    const std::uint32_t kind = flatten::leaf_kind(leaf), n = leaf_blocks(walk_.form(), leaf);
    const auto width = static_cast<std::size_t>(walk_.form().block);
    const layout::u32* words = blocks_of(walk_.form(), kind).data() +
                               (leaf & KDRAY_WIDE_FIRST_MASK) * kBlockRows[kind] * width +
                               (kBlockRows[kind] - 1) * width;
    for (std::uint32_t b = 0; b < n; ++b, words += kBlockRows[kind] * width)
      for (std::size_t lane = 0; lane < width; ++lane) {
        const std::uint32_t index = words[lane] & ~KDRAY_WIDE_LAST;
        held_[kind][index] = true;
        if (in_mesh_) sizes_.meshes[kind] = std::min(sizes_.meshes[kind], index);
        if (words[lane] & KDRAY_WIDE_LAST) break;  // the last primitive; empty lanes follow
      }
    sizes_.blocks[kind] += n;
  }

  void list_primitives() {
    for (std::uint32_t kind = 0; kind < kKinds; ++kind)
      for (std::uint32_t i = 0; i < held_[kind].size(); ++i)
        if (held_[kind][i]) {
          sizes_.primitives[kind].push_back(i);
          holders_.add(kind, i);
        }
  }

  const flatten::FlatScene& scene_;
  const PartWalk& walk_;
  Holders& holders_;
  std::array<std::vector<bool>, kKinds> held_;
  bool in_mesh_ = false;
  Sizes sizes_;
};

// The primitives of a part by kind, and the place that each of the scene's has there.
struct Numbering {
  std::array<std::vector<std::uint32_t>, kKinds> members;
  std::array<std::vector<std::uint32_t>, kKinds> place;  // of members only
  std::uint32_t n_shared = 0;
};

// Primitives of meshes, which lie behind the scene's own, count as a part's own, whoever else holds them.
Numbering number(const Holders& holders, const flatten::FlatScene& scene, const Sizes& sizes) {
  Numbering n;
  for (std::uint32_t kind = 0; kind < kKinds; ++kind) {
    const std::vector<std::uint32_t>& of = holders.of[kind];
    std::vector<std::uint32_t> own;
    for (const std::uint32_t i : sizes.primitives[kind])
      (of[i] == 1 || i >= sizes.meshes[kind] ? own : n.members[kind]).push_back(i);
    if (kind == KDRAY_KIND_TRIANGLE) {
      n.n_shared = static_cast<std::uint32_t>(n.members[kind].size());
      std::sort(n.members[kind].begin(), n.members[kind].end(), [&](std::uint32_t a, std::uint32_t b) {
        return scene.triangles[a].number < scene.triangles[b].number;
      });
    }
    n.members[kind].insert(n.members[kind].end(), own.begin(), own.end());
    n.place[kind].resize(of.size());
    for (std::uint32_t i = 0; i < n.members[kind].size(); ++i) n.place[kind][n.members[kind][i]] = i;
  }
  return n;
}

// Second pass: copies nodes and blocks, with the children's and the primitives' new places.
class Copying {
 public:
  Copying(const PartWalk& walk, const Sizes& sizes, const Numbering& numbering, flatten::WideForm& out)
      : walk_(walk), sizes_(sizes), numbering_(numbering), out_(out) {
    const auto width = static_cast<std::size_t>(walk.form().block);
    out.block = walk.form().block;
    out.widen = walk.form().widen;
    out.stack_size = walk.form().stack_size;  // a part's is no larger than the whole's
    out.nodes = Array<layout::WideNode>(sizes.nodes);
    for (std::uint32_t kind = 0; kind < kKinds; ++kind)
      blocks_of(out, kind) = Array<layout::u32>(sizes.blocks[kind] * kBlockRows[kind] * width);
    n_nodes_ = 1;
    copy_opened(0, 0);
    for (const layout::u32 root : sizes.roots) roots_[root] = copy_child(root, n_nodes_++);
  }

  // The part's instances, of meshes that are where they have been copied to.
  Array<layout::Instance> instances(const flatten::FlatScene& scene) const {
    Array<layout::Instance> some(sizes_.instances.size());
    for (std::size_t i = 0; i < some.size(); ++i) {
      some[i] = scene.instances[sizes_.instances[i]];
      some[i].root = roots_.at(some[i].root);
      some[i].number = sizes_.instances[i];
      some[i].whole = static_cast<layout::u32>(i);
    }
    return some;
  }

 private:
  static void clear_slot(layout::WideNode& node, std::uint32_t slot) {
    flatten::set_bounds(node, slot, {});
    node.child[slot] = 0;
  }

  // Inner children of a node get neighbouring places, as flatten/collapse gives them.
  void copy_opened(std::size_t i, std::size_t place) {
    const OpenedNode& opened = walk_.cut().top[i];
    layout::WideNode node = walk_.form().nodes[opened.node];
    std::array<std::size_t, 8> places{};
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      if (!walk_.holds(opened.below[slot])) {
        clear_slot(node, slot);
      } else if (opened.below[slot] >= 0 || !(node.child[slot] & KDRAY_WIDE_LEAF)) {
        places[slot] = n_nodes_++;
      }
    }
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      if (!walk_.holds(opened.below[slot])) continue;
      if (opened.below[slot] >= 0) {
        copy_opened(static_cast<std::size_t>(opened.below[slot]), places[slot]);
        node.child[slot] = static_cast<layout::u32>(places[slot]);
      } else {
        node.child[slot] = copy_child(node.child[slot], places[slot]);
      }
    }
    out_.nodes[place] = node;
  }

  layout::u32 copy_child(layout::u32 child, std::size_t place) {
    if (child & KDRAY_WIDE_LEAF) return copy_leaf(child);
    layout::WideNode node = walk_.form().nodes[child];
    std::array<std::size_t, 8> places{};
    for (std::uint32_t slot = 0; slot < 8; ++slot)
      if (!is_empty(node, slot) && !(node.child[slot] & KDRAY_WIDE_LEAF)) places[slot] = n_nodes_++;
    for (std::uint32_t slot = 0; slot < 8; ++slot)
      if (!is_empty(node, slot)) node.child[slot] = copy_child(node.child[slot], places[slot]);
    out_.nodes[place] = node;
    return static_cast<layout::u32>(place);
  }

  layout::u32 copy_instance(layout::u32 leaf) const {
    const auto at =
        std::lower_bound(sizes_.instances.begin(), sizes_.instances.end(), leaf & KDRAY_WIDE_FIRST_MASK);
    return KDRAY_INSTANCE_LEAF | static_cast<layout::u32>(at - sizes_.instances.begin());
  }

  layout::u32 copy_leaf(layout::u32 leaf) {
    if (is_instance(leaf)) return copy_instance(leaf);
    const std::uint32_t kind = flatten::leaf_kind(leaf), n = leaf_blocks(walk_.form(), leaf);
    const auto width = static_cast<std::size_t>(walk_.form().block);
    const std::size_t words = kBlockRows[kind] * width;
    const layout::u32* from = blocks_of(walk_.form(), kind).data() + (leaf & KDRAY_WIDE_FIRST_MASK) * words;
    layout::u32* to = blocks_of(out_, kind).data() + n_blocks_[kind] * words;
    std::copy(from, from + n * words, to);
    for (std::uint32_t b = 0; b < n; ++b)
      rename(to + b * words + (kBlockRows[kind] - 1) * width, width, numbering_.place[kind]);
    const auto first = static_cast<layout::u32>(n_blocks_[kind]);
    n_blocks_[kind] += n;
    return (leaf & ~KDRAY_WIDE_FIRST_MASK) | first;
  }

  static void rename(layout::u32* indices, std::size_t width, const std::vector<std::uint32_t>& place) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      const layout::u32 last = indices[lane] & KDRAY_WIDE_LAST;
      indices[lane] = place[indices[lane] & ~KDRAY_WIDE_LAST] | last;
      if (last) break;
    }
  }

  const PartWalk& walk_;
  const Sizes& sizes_;
  const Numbering& numbering_;
  flatten::WideForm& out_;
  std::size_t n_nodes_ = 0;
  std::unordered_map<layout::u32, layout::u32> roots_;  // of meshes, by what they are in the whole
  std::array<std::size_t, kKinds> n_blocks_{};
};

template <class T>
Array<T> select(const Array<T>& all, const std::vector<std::uint32_t>& members) {
  Array<T> some(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) some[i] = all[members[i]];
  return some;
}

// Of an array that has none, or as many for each of n primitives.
template <class T>
Array<T> select_rows(const Array<T>& all, const std::vector<std::uint32_t>& members, std::size_t n) {
  const std::size_t each = n == 0 ? 0 : all.size() / n;
  Array<T> some(members.size() * each);
  for (std::size_t i = 0; i < members.size(); ++i)
    for (std::size_t k = 0; k < each; ++k) some[i * each + k] = all[members[i] * each + k];
  return some;
}

flatten::FlatScene select_primitives(const flatten::FlatScene& scene, const Numbering& n) {
  flatten::FlatScene flat;
  primitives::for_each_kind([&](auto kind) {
    decltype(kind)::of(flat) = select(decltype(kind)::of(scene), n.members[kind.kNumber]);
  });
  flat.materials = scene.materials;
  flat.material_maps = scene.material_maps;
  flat.textures = scene.textures;
  flat.texels = scene.texels;
  const auto& triangles = n.members[KDRAY_KIND_TRIANGLE];
  flat.corner_colors = select_rows(scene.corner_colors, triangles, scene.triangles.size());
  flat.texcoords = select_rows(scene.texcoords, triangles, scene.triangles.size());
  flat.lights = scene.lights;
  flat.sky = scene.sky;
  flat.sky_colors = scene.sky_colors;
  std::vector<std::uint32_t> normals;
  for (layout::Triangle& t : flat.triangles) {
    if (t.normals == KDRAY_NO_NORMALS) continue;
    normals.push_back(t.normals & KDRAY_NORMALS_MASK);
    t.normals = (t.normals & KDRAY_ZERO_AREA) | static_cast<layout::u32>(normals.size() - 1);
  }
  flat.normals = select(scene.normals, normals);
  return flat;
}

// Of all parts, so that each tells the primitives of meshes, wherever those are used.
void share_first_of_meshes(std::vector<Sizes>& sizes) {
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    std::uint32_t first = std::numeric_limits<std::uint32_t>::max();
    for (const Sizes& s : sizes) first = std::min(first, s.meshes[kind]);
    for (Sizes& s : sizes) s.meshes[kind] = first;
  }
}

Box box_of(const layout::PartCell& cell) {
  return {{cell.lo[0], cell.lo[1], cell.lo[2]}, {cell.hi[0], cell.hi[1], cell.hi[2]}};
}

layout::PartCell cell_of(std::uint32_t part, const Box& box) {
  return {{box.lo.x, box.lo.y, box.lo.z}, part, {box.hi.x, box.hi.y, box.hi.z}, 0};
}

// What lies below an opened node's child, but for what every part holds.
struct Below {
  bool several = false;             // parts
  std::uint32_t part = kEveryPart;  // kEveryPart: there is nothing else
  Box bounds;

  void add(const Below& o) {
    if (o.part == kEveryPart) return;
    several = several || o.several || (part != kEveryPart && part != o.part);
    part = o.part;
    bounds.grow(o.bounds);
  }
};

Below below_of(const flatten::WideForm& form, const Cut& cut, std::span<const std::uint32_t> part_of,
               std::int32_t below, const Box& bounds) {
  if (below < 0) return {false, part_of[static_cast<std::size_t>(-1 - below)], bounds};
  Below all;
  const OpenedNode& opened = cut.top[static_cast<std::size_t>(below)];
  for (std::uint32_t slot = 0; slot < 8; ++slot)
    if (opened.below[slot] != OpenedNode::kEmpty)
      all.add(
          below_of(form, cut, part_of, opened.below[slot], bounds_of_child(form.nodes[opened.node], slot)));
  return all;
}

// Writes the cells of the parts, in the tree's order: what lies within a cell comes behind it.
class Directory {
 public:
  Directory(const flatten::WideForm& form, const Cut& cut, std::span<const std::uint32_t> part_of)
      : form_(form), cut_(cut), part_of_(part_of) {
    if (!cut.top.empty()) add_largest(0);
  }

  // Each part's cells behind the bounds of them all.
  std::vector<layout::PartCell> cells() const {
    std::vector<layout::PartCell> all;
    for (const auto& [part, cells] : cells_) {
      if (!is_one(cells)) {
        Box bounds;
        for (std::size_t i = 0; i < cells.size(); i += 1 + cells[i].n_below) bounds.grow(box_of(cells[i]));
        all.push_back(cell_of(part, bounds));
        all.back().n_below = static_cast<layout::u32>(cells.size());
      }
      all.insert(all.end(), cells.begin(), cells.end());
    }
    return all;
  }

 private:
  using Cells = std::vector<layout::PartCell>;

  static bool is_one(const Cells& cells) { return cells.front().n_below + 1 == cells.size(); }

  // The largest nodes of the top whose contents lie in one part.
  void add_largest(std::size_t i) {
    const OpenedNode& opened = cut_.top[i];
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      const std::int32_t below = opened.below[slot];
      if (below == OpenedNode::kEmpty) continue;
      const Below all =
          below_of(form_, cut_, part_of_, below, bounds_of_child(form_.nodes[opened.node], slot));
      if (all.several) {
        add_largest(static_cast<std::size_t>(below));
      } else if (all.part != kEveryPart) {
        add(below, all, cells_[all.part]);
      }
    }
  }

  void add(std::int32_t below, const Below& all, Cells& cells) {
    if (below < 0) return add_subtree(cut_.subtrees[static_cast<std::size_t>(-1 - below)].child, all, cells);
    const std::size_t first = begin(all.bounds, all.part, cells);
    const OpenedNode& opened = cut_.top[static_cast<std::size_t>(below)];
    for (std::uint32_t slot = 0; slot < 8; ++slot) {
      if (opened.below[slot] == OpenedNode::kEmpty) continue;
      const Below child = below_of(form_, cut_, part_of_, opened.below[slot],
                                   bounds_of_child(form_.nodes[opened.node], slot));
      if (child.part != kEveryPart) add(opened.below[slot], child, cells);
    }
    end(first, cells);
  }

  // With the children of its root, which half as many rays meet.
  void add_subtree(layout::u32 root, const Below& all, Cells& cells) {
    const std::size_t first = begin(all.bounds, all.part, cells);
    for (std::uint32_t slot = 0; slot < 8 && !(root & KDRAY_WIDE_LEAF); ++slot) {
      const Box bounds = bounds_of_child(form_.nodes[root], slot);
      if (!bounds.empty()) cells.push_back(cell_of(all.part, bounds));
    }
    end(first, cells);
  }

  static std::size_t begin(const Box& bounds, std::uint32_t part, Cells& cells) {
    cells.push_back(cell_of(part, bounds));
    return cells.size() - 1;
  }
  static void end(std::size_t first, Cells& cells) {
    if (cells.size() == first + 2) cells.pop_back();  // one within it tells nothing more
    cells[first].n_below = static_cast<layout::u32>(cells.size() - 1 - first);
  }

  const flatten::WideForm& form_;
  const Cut& cut_;
  std::span<const std::uint32_t> part_of_;
  std::map<std::uint32_t, Cells> cells_;  // by part
};

}  // namespace

std::size_t geometry_bytes(const flatten::FlatScene& flat, const flatten::WideForm& wide) {
  std::size_t bytes = flat.normals.bytes() + flat.texcoords.bytes() + flat.corner_colors.bytes() +
                      flat.instances.bytes() + wide.bytes();
  primitives::for_each_kind([&](auto kind) { bytes += decltype(kind)::of(flat).bytes(); });
  return bytes;
}

std::size_t Part::geometry_bytes() const {
  return odprt::geometry_bytes(flat, wide);
}

std::vector<Part> make_parts(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                             std::span<const std::uint32_t> part_of, std::uint32_t n_parts) {
  Holders holders(scene);
  std::vector<Sizes> sizes(n_parts);
  tbb::parallel_for(0u, n_parts, [&](std::uint32_t part) {
    sizes[part] = Counting(scene, PartWalk(form, cut, part_of, part), holders).sizes();
  });
  share_first_of_meshes(sizes);
  std::vector<Part> parts(n_parts);
  tbb::parallel_for(0u, n_parts, [&](std::uint32_t part) {
    const Numbering numbering = number(holders, scene, sizes[part]);
    parts[part].flat = select_primitives(scene, numbering);
    parts[part].n_shared = numbering.n_shared;
    const PartWalk walk(form, cut, part_of, part);
    parts[part].flat.instances = Copying(walk, sizes[part], numbering, parts[part].wide).instances(scene);
  });
  return parts;
}

std::vector<layout::PartCell> make_directory(const flatten::WideForm& form, const Cut& cut,
                                             std::span<const std::uint32_t> part_of) {
  return Directory(form, cut, part_of).cells();
}

}  // namespace kdray::odprt
