// What    Reads a wide form's blocks lane by lane, as the kernels do.
#pragma once

#include <bit>
#include <cstddef>

#include "accel/flatten/wide.h"

namespace kdray::flatten {

using layout::u32;

inline constexpr int kKinds = static_cast<int>(primitives::kKinds);
#define KDRAY_ROWS(NAME, name, names, Struct) KDRAY_##NAME##_ROWS,
inline constexpr int kRows[kKinds] = {KDRAY_KINDS(KDRAY_ROWS)};
#undef KDRAY_ROWS

inline const Array<u32>& blocks_of(const WideForm& wide, int kind) {
  return primitives::with_kind(static_cast<u32>(kind),
                               [&](auto k) -> const Array<u32>& { return decltype(k)::blocks_of(wide); });
}

// A lane of the kind's array, as numbered through all blocks.
struct Lane {
  const u32* words;
  int block, rows;

  Lane(const WideForm& wide, int kind, std::size_t number)
      : words(&blocks_of(wide, kind)[number / wide.block * wide.block * kRows[kind] + number % wide.block]),
        block(wide.block),
        rows(kRows[kind]) {}
  float number(int row) const { return std::bit_cast<float>(words[row * block]); }
  u32 index() const { return words[(rows - 1) * block] & ~KDRAY_WIDE_LAST; }
  bool is_last() const { return words[(rows - 1) * block] & KDRAY_WIDE_LAST; }
};

}  // namespace kdray::flatten
