// What    A scene divided for ODPRT: its subtrees, the part of each, and the parts' geometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "cluster/transport/together.h"
#include "engine/odprt/rank_table.h"
#include "engine/odprt/subtrees.h"
#include "layout/odprt.layout.h"

namespace kdray::odprt {

// The parts of a divided scene: each holds the wide tree's top as far as it leads to its own subtrees,
// those subtrees, and the primitives in them; and the directory that tells rays which parts they meet. A
// primitive that lies in subtrees of several parts is in all of those. A part's triangles begin with such
// ones, ordered by number, so that a shadow ray from elsewhere can name the one that it left. A mesh is
// whole in every part that has an instance of it; an instance is in one part. Materials and lights are
// everywhere. Why: The whole form's stack, blocks and boxes stay what they are, so one program serves the
// whole and every part, and a ray meets in the parts what it would meet in the whole.
struct Part {
  flatten::FlatScene flat;  // without a binary tree
  flatten::WideForm wide;
  std::uint32_t n_shared = 0;  // triangles that other parts hold too

  // The bytes of the part's share of the geometry. Materials and lights don't count, since every part has
  // them.
  std::size_t geometry_bytes() const;
};

std::size_t geometry_bytes(const flatten::FlatScene& flat, const flatten::WideForm& wide);

// `part_of` has the part of each subtree.
std::vector<Part> make_parts(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                             std::span<const std::uint32_t> part_of, std::uint32_t n_parts);

// The bounds of what the parts hold, in the order of parts: of all that a part holds, and behind that, cell
// within cell, of the largest nodes whose contents lie in that part, of what there is of the tree's top
// below, and of the children of the subtrees' roots.
std::vector<layout::PartCell> make_directory(const flatten::WideForm& form, const Cut& cut,
                                             std::span<const std::uint32_t> part_of);

struct Division {
  std::vector<std::uint32_t> part_of;  // of each subtree; kEveryPart (assign.h)
  std::vector<layout::PartCell> directory;
  std::vector<Part> parts;

  bool replicates() const;  // some subtrees are in every part
  // The subtrees of a part, in the order of the census.
  std::vector<std::uint32_t> subtrees_of(std::uint32_t part) const;
};

// The bytes of the geometry of the largest part.
std::size_t largest_bytes(const Division& division);

struct DivideOptions {
  std::uint32_t n_parts = 1;
  double spare = 0;       // of the scene's bytes, that a part may take beyond an equal share, if possible
  double replicated = 0;  // ... of which so much may be what every part holds

  bool operator==(const DivideOptions&) const = default;
};

// The share of the geometry that a part may take beyond its equal one, where memory is not short; and what of
// that may be held by every part.
inline constexpr double kSpare = 0.19, kReplicated = 0.16;

// The part of each subtree, or kEveryPart. `costs` of the subtrees, of any unit.
std::vector<std::uint32_t> assign(const Cut& cut, std::span<const double> costs,
                                  const DivideOptions& options);

Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::span<const double> costs, const DivideOptions& options);
// By what somebody has assigned.
Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::vector<std::uint32_t> part_of, std::uint32_t n_parts);

// A scene that no rank has whole: each divides its partition among its own queues, and all get to know the
// bounds of everybody's parts. The division is that of the whole scene, with parts for the queues of all
// ranks; those of other ranks are empty here. Subtrees are this rank's own. Nothing is held by several
// ranks, and a rank's part may have nothing in it. Errors: ErrorCode::internal: a rank that tells of parts
// which are not its own.

// All ranks call it. `costs` of the subtrees.
Division divide_partition(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                          std::span<const double> costs, const RankTable& table, transport::Together& all);

// How many subtrees this rank is to cut its partition into, of those of all ranks.
std::size_t subtrees_of_rank(std::size_t n_subtrees, const RankTable& table);

}  // namespace kdray::odprt
