// What    Memory for parting one cell's references into groups (sweep-inl.h): written before it is read, for
//         each cell anew.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "accel/kdtree/tree.h"

namespace kdray::kdtree::binned {

// Cells of up to so many references are swept; larger ones are parted between steps before.
inline constexpr std::size_t kSwept = 512;

struct SweepBuffers {
  static constexpr std::size_t kPadded = kSwept + 32;  // vectors may reach beyond the last
  using Corner = std::array<float, 4>;                 // x, y, z, and a lane that nothing reads

  // The references' bounds relative to the cell's longest edge, and their centres in steps of 16 bits.
  alignas(64) std::array<Corner, kSwept> lo, hi;
  alignas(64) std::array<std::array<std::int16_t, kPadded>, 3> center;

  // The references by their centres along each axis.
  alignas(64) std::array<std::array<std::uint16_t, kSwept>, 3> order;

  // Edges of the hulls of a group's first i references along an axis, and of the others.
  using Edges = std::array<Corner, kPadded>;
  alignas(64) Edges first, second;

  // What a test of i references costs, and of kSwept - i.
  alignas(64) std::array<float, kPadded> tests, tests_backward;

  alignas(64) std::array<std::int16_t, kPadded> ranks;
  std::array<std::uint16_t, kSwept> ties, others;
  std::array<std::uint8_t, kSwept> is_second;

  // The nodes of the groups, before they go to the fragment.
  std::array<Node, 2 * kSwept> nodes;
  std::array<Box, 2 * kSwept> contents;
  std::array<Ref, kSwept> refs;
  std::size_t n_nodes, n_refs;

  // Nothing is written: std::array of what has initialisers would be.
  SweepBuffers() {}  // NOLINT
};

}  // namespace kdray::kdtree::binned
