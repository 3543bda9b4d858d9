// What    The kinds of primitives in a wide form, by number: how many rows their blocks have, and where these
//         are.
#pragma once

#include <array>
#include <cstdint>

#include "flatten/wide.h"
#include "layout/wide.layout.h"

namespace kdray::odprt {

inline constexpr std::uint32_t kKinds = 3;
inline constexpr std::array<std::uint32_t, kKinds> kBlockRows = {KDRAY_TRIANGLE_ROWS, KDRAY_SPHERE_ROWS,
                                                                 KDRAY_CONE_ROWS};

inline Array<layout::u32>& blocks_of(flatten::WideForm& form, std::uint32_t kind) {
  return kind == 0 ? form.triangle_blocks : kind == 1 ? form.sphere_blocks : form.cone_blocks;
}
inline const Array<layout::u32>& blocks_of(const flatten::WideForm& form, std::uint32_t kind) {
  return kind == 0 ? form.triangle_blocks : kind == 1 ? form.sphere_blocks : form.cone_blocks;
}

}  // namespace kdray::odprt
