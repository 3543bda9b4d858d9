// What    The kinds of primitives in a wide form, by number: how many rows their blocks have, and where these
//         are.
#pragma once

#include <array>
#include <cstdint>

#include "accel/flatten/wide.h"
#include "layout/wide.layout.h"
#include "scene/primitives/kinds.h"

namespace kdray::odprt {

using primitives::kKinds;

#define KDRAY_ROWS_OF_KIND(NAME, name, names, Struct) KDRAY_##NAME##_ROWS,
inline constexpr std::array<std::uint32_t, kKinds> kBlockRows = {KDRAY_KINDS(KDRAY_ROWS_OF_KIND)};
#undef KDRAY_ROWS_OF_KIND

template <class Form>
auto& blocks_of(Form& form, std::uint32_t number) {
  return primitives::with_kind(
      number, [&](auto kind) -> auto& { return decltype(kind)::blocks_of(form); });
}

}  // namespace kdray::odprt
