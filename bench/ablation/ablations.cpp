// What    All that `kdray bench ablation` can take away.
#include "accel/flatten/features.h"
#include "bench/ablation/bench.h"
#include "layout/features.h"

namespace kdray::bench {

namespace {

constexpr layout::Features kSecondary = KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT;
// Above 0, which asks for rays of no weight too, and below what any ray weighs.
constexpr double kNoWeight = 1e-30;

struct Rule {
  std::uint64_t bit;
  const char* name;
  layout::Features any_of;  // features without which it has nothing to do; 0: it always has
};
constexpr Rule kRules[] = {
    {KDRAY_KEEP_FRUSTUM, "children that a packet's frustum misses", 0},
    {KDRAY_KEEP_BEYOND, "children behind the best hit", 0},
    {KDRAY_KEEP_NEARNESS, "roots of cones passed by", KDRAY_FEATURE_KIND(CONE)},
    {KDRAY_KEEP_OCCLUDER, "walks that the last occluder ends", KDRAY_FEATURE_LIGHTS},
    {KDRAY_KEEP_BEHIND, "shadow rays to lights behind", KDRAY_FEATURE_LIGHTS},
    {KDRAY_KEEP_UNLIT, "shadow rays of no light", KDRAY_FEATURE_LIGHTS},
    {KDRAY_KEEP_OPEN, "rays that pass the core by", KDRAY_FEATURE_FACES},
    {KDRAY_KEEP_EMPTY, "eye rays of empty blocks", 0},
    {KDRAY_KEEP_LEFT, "the triangle a ray leaves", KDRAY_FEATURE_KIND(TRIANGLE)},
    {KDRAY_KEEP_WEIGHTLESS, "secondary rays of no weight", kSecondary},
};

bool applies(const Rule& rule, layout::Features features) {
  if (rule.bit == KDRAY_KEEP_LEFT && !(features & (KDRAY_FEATURE_LIGHTS | kSecondary))) return false;
  return rule.any_of == 0 || (features & rule.any_of) != 0;
}

// Shadow rays of a smooth triangle begin on the curve that it stands for, which may lie behind it.
bool is_exact(const Rule& rule, layout::Features features) {
  constexpr layout::Features kSmoothAndLit = KDRAY_FEATURE_SMOOTH | KDRAY_FEATURE_LIGHTS;
  return rule.bit != KDRAY_KEEP_LEFT || (features & kSmoothAndLit) != kSmoothAndLit;
}

}  // namespace

const char* name_of(Ablation::Kind kind) {
  static constexpr const char* kNames[] = {"none", "specialisation", "rule", "everything"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<Ablation> ablations_for(layout::Features features) {
  std::vector<Ablation> all;
  std::uint64_t code = 0, work = 0;
  for (const flatten::Feature& f : flatten::features()) {
    if (features & f.bit) continue;
    all.push_back(
        {.name = std::string("no ") + f.name, .kind = Ablation::Kind::specialisation, .keep = f.bit});
    code |= f.bit;
  }
  if (code != 0)
    all.push_back({.name = "all of these", .kind = Ablation::Kind::specialisation, .keep = code});
  for (const Rule& rule : kRules) {
    if (!applies(rule, features)) continue;
    const bool exact = is_exact(rule, features);
    all.push_back({.name = rule.name, .kind = Ablation::Kind::rule, .exact = exact, .keep = rule.bit});
    if (exact) work |= rule.bit;
  }
  if (features & kSecondary) {
    Ablation inexact{.name = "rays below the least weight", .kind = Ablation::Kind::rule, .exact = false};
    inexact.min_weight_off = true;
    all.push_back(inexact);
    inexact.name = "rays too deep, to twice the depth";
    inexact.min_weight_off = false, inexact.twice_as_deep = true;
    all.push_back(inexact);
  }
  all.push_back({.name = "everything exact", .kind = Ablation::Kind::everything, .keep = code | work});
  return all;
}

RenderOptions with(const Ablation& ablation, RenderOptions options) {
  if (ablation.min_weight_off) options.min_weight = kNoWeight;
  if (ablation.twice_as_deep) options.depth *= 2;
  return options;
}

}  // namespace kdray::bench
