// What    The list of primitive kinds (kernels/layout/kinds.h) as types: for_each_kind() and with_kind() are
//         how the host does something for each of them, or for one that it knows by its number.
// Shape   Whatever holds an array for each kind names them by the kinds' plurals, as Scene, Geometry,
//         FlatScene and SceneBuffers do; Kind::of(holder) is the array. `Kind` as a parameter is one of the
//         types below.
// Why     All of it is resolved when compiling: a visit costs what the code written out by hand does, and a
//         function that one kind lacks is an error that names the kind.
// Errors  with_kind: ErrorCode::internal for a number that no kind has.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "layout/wide.layout.h"

namespace kdray::primitives {

inline constexpr std::uint32_t kKinds = KDRAY_N_KINDS;

#define KDRAY_NAME_OF(NAME, name, names, Struct) name = KDRAY_KIND_##NAME,
enum class PrimitiveKind : std::uint32_t { KDRAY_KINDS(KDRAY_NAME_OF) };
#undef KDRAY_NAME_OF

// What all kinds have.
#define KDRAY_OF_ANY_KIND(NAME, name, names, Struct)            \
  static constexpr PrimitiveKind kKind = PrimitiveKind::name;   \
  static constexpr std::uint32_t kNumber = KDRAY_KIND_##NAME;   \
  static constexpr std::uint32_t kRows = KDRAY_##NAME##_ROWS;   \
  static constexpr const char *kName = #name, *kNames = #names; \
  using Layout = layout::Struct;                                \
  template <class Arrays>                                       \
  static constexpr auto& of(Arrays& arrays) {                   \
    return arrays.names;                                        \
  }                                                             \
  template <class Form>                                         \
  static constexpr auto& blocks_of(Form& form) {                \
    return form.name##_blocks;                                  \
  }

struct TriangleKind {
  static constexpr bool kIsShape = false;
  KDRAY_OF_ANY_KIND(TRIANGLE, triangle, triangles, Triangle)
};

// A shape as a file has it (Source: in double, in the world) and as the tree has it (Geometry: in float,
// about the scene's centre): <kind>.h.
#define KDRAY_SHAPE_KIND(NAME, name, names, Struct) \
  struct Struct;                                    \
  struct Struct##Geometry;                          \
  struct Struct##Kind {                             \
    static constexpr bool kIsShape = true;          \
    using Source = primitives::Struct;              \
    using Geometry = primitives::Struct##Geometry;  \
    KDRAY_OF_ANY_KIND(NAME, name, names, Struct)    \
  };
KDRAY_SHAPES(KDRAY_SHAPE_KIND)
#undef KDRAY_SHAPE_KIND
#undef KDRAY_OF_ANY_KIND

#define KDRAY_VISIT_KIND(NAME, name, names, Struct) visit(Struct##Kind());

// Calls visit(Kind()) for each kind, in the order of their numbers.
template <class Visit>
constexpr void for_each_kind(const Visit& visit) {
  KDRAY_KINDS(KDRAY_VISIT_KIND)
}

// Calls it for all kinds but triangles.
template <class Visit>
constexpr void for_each_shape(const Visit& visit) {
  KDRAY_SHAPES(KDRAY_VISIT_KIND)
}
#undef KDRAY_VISIT_KIND

[[noreturn]] void throw_unknown_kind(std::uint32_t number);

// Calls visit(Kind()) for the kind of that number, and returns what it returns.
#define KDRAY_CASE_OF_KIND(NAME, name, names, Struct) \
  case KDRAY_KIND_##NAME:                             \
    return visit(Struct##Kind());
template <class Visit>
constexpr decltype(auto) with_kind(std::uint32_t number, const Visit& visit) {
  switch (number) {
    KDRAY_KINDS(KDRAY_CASE_OF_KIND)
    default:
      throw_unknown_kind(number);
  }
}
#undef KDRAY_CASE_OF_KIND

// Returns the sum over all kinds of what `holder` has of each.
template <class Holder>
std::size_t count_primitives(const Holder& holder) {
  std::size_t n = 0;
  for_each_kind([&](auto kind) { n += decltype(kind)::of(holder).size(); });
  return n;
}

// Returns "12 triangles, 3 spheres": count_of(Kind()) of each kind of which there are any; "nothing" where
// there are none.
template <class CountOf>
std::string counts_in_words(const CountOf& count_of) {
  std::string words;
  for_each_kind([&](auto kind) {
    if (const std::uint64_t n = count_of(kind); n > 0)
      words += (words.empty() ? "" : ", ") + std::to_string(n) + " " + kind.kNames;
  });
  return words.empty() ? "nothing" : words;
}

}  // namespace kdray::primitives
