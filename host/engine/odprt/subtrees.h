// What    Cuts the wide form of a scene into subtrees of about equal expected cost: what ODPRT assigns to
//         queues.
// Shape   An instance is a leaf: it is as dear as its mesh, whose bytes its instances share.
//         The costliest subtree is opened until there are enough. Subtrees come in the kd-tree's own order,
//         so that neighbours in the list are neighbours in space; their cells are disjoint.
// Source  T. V. Christensen, "Parallel Ray Tracing", DTU 2009: object-distributed. Costs: the surface-area
//         heuristic.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "accel/flatten/leaf_block.h"
#include "accel/flatten/wide.h"
#include "base/box.h"
#include "layout/wide.layout.h"
#include "scene/primitives/kinds.h"

namespace kdray::odprt {

// The kinds of primitives in a wide form, by number: how many rows their blocks have, and where these are.
using primitives::kKinds;

#define KDRAY_ROWS_OF_KIND(NAME, name, names, Struct) KDRAY_##NAME##_ROWS,
inline constexpr std::array<std::uint32_t, kKinds> kBlockRows = {KDRAY_KINDS(KDRAY_ROWS_OF_KIND)};
#undef KDRAY_ROWS_OF_KIND

template <class Form>
auto& blocks_of(Form& form, std::uint32_t number) {
  return primitives::with_kind(
      number, [&](auto kind) -> auto& { return decltype(kind)::blocks_of(form); });
}

using flatten::bounds_of_child, flatten::is_instance;

struct Subtree {
  Box bounds;               // of its contents
  double cost = 0;          // expected: nodes and blocks that a ray through the scene's bounds meets in it
  double visit = 0;         // expected cost of a ray that meets the subtree's own bounds
  std::uint64_t bytes = 0;  // of its nodes, blocks and primitives
  layout::u32 child = 0;    // the wide node's word: a node or a leaf
  bool placed = false;      // there are instances in it
};

// What rays did with a subtree.
struct SubtreeUse {
  std::uint64_t visits = 0, hits = 0;
};

// An opened node of the wide tree, and what became of its children.
struct OpenedNode {
  static constexpr std::int32_t kEmpty = INT32_MIN;

  std::uint32_t node = 0;
  // For each slot the number of an opened node, or -1 - the number of a subtree, or kEmpty.
  std::array<std::int32_t, 8> below{};
};

struct Cut {
  std::vector<OpenedNode> top;    // [0] is the root
  std::vector<Subtree> subtrees;  // in the order of the tree
};

// Cuts the form into at least `n` subtrees, if the tree has as many that can be told apart.
Cut cut(const flatten::FlatScene& scene, const flatten::WideForm& form, std::size_t n);

// The number of blocks of a leaf; an instance counts as one.
std::uint32_t leaf_blocks(const flatten::WideForm& form, layout::u32 leaf);

// Tells which subtree of a cut a point lies in. Cells are disjoint, so that a point of a surface lies in
// one subtree's bounds, or, where rounding has moved it out, nearest to them; on a plane between two, which
// hold what lies in it both, in either.
class Locator {
 public:
  // Refers to both.
  Locator(const flatten::WideForm& form, const Cut& cut) : form_(form), cut_(cut) {}

  // None for a cut without subtrees.
  std::optional<std::uint32_t> find(const vec3& point) const;

 private:
  struct Nearest {
    float distance;  // squared
    std::optional<std::uint32_t> subtree = {};
  };
  void look_below(std::size_t opened, const vec3& point, Nearest& nearest) const;

  const flatten::WideForm& form_;
  const Cut& cut_;
};

}  // namespace kdray::odprt
