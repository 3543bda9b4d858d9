// What    How many primitives of each kind a scene has, as the tables and reports tell it.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "bench/measure/report.h"
#include "scene/primitives/kinds.h"

namespace kdray::bench {

struct KindCounts {
  std::array<std::uint64_t, primitives::kKinds> of{};  // by the kinds' numbers
};

// `holder`: whatever has an array for each kind.
template <class Holder>
KindCounts kind_counts(const Holder& holder) {
  KindCounts counts;
  primitives::for_each_kind([&](auto kind) { counts.of[kind.kNumber] = decltype(kind)::of(holder).size(); });
  return counts;
}

// "12 triangles, 3 spheres"
inline std::string in_words(const KindCounts& counts) {
  return primitives::counts_in_words([&](auto kind) { return counts.of[kind.kNumber]; });
}

inline Json json_of(const KindCounts& counts) {
  Json json = Json::object();
  primitives::for_each_kind([&](auto kind) { json[kind.kNames] = counts.of[kind.kNumber]; });
  return json;
}

}  // namespace kdray::bench
