// What    What `kdray bench ablation` takes away, one thing at a time: a specialisation (the code that a
//         scene doesn't need is compiled in) or a rule (the work that it would leave out is done).
// Shape   A rule is exact where it claims that no bit of the picture depends on it. The two that are not
//         leave out light below --min-weight, and what is deeper than --depth.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kdray/kdray.h"
#include "layout/features.h"

namespace kdray::bench {

struct Ablation {
  std::string name;  // of what is taken away
  enum class Kind { none, specialisation, rule, everything } kind = Kind::none;
  bool exact = true;
  std::uint64_t keep = 0;       // api::Hooks::keep
  bool min_weight_off = false;  // rays are spawned whatever they weigh, unless nothing
  bool twice_as_deep = false;
};

const char* name_of(Ablation::Kind kind);

// All that can be taken from frames with this mask of features; last everything that is exact at once.
std::vector<Ablation> ablations_for(layout::Features features);

RenderOptions with(const Ablation& ablation, RenderOptions options);

}  // namespace kdray::bench
