#include "device/tuning/settings.h"

#include <fmt/format.h>

#include <algorithm>

namespace kdray::tuning {

namespace {

constexpr std::string_view kWalks = "wave/wave.cl, odprt/wave.cl, traverse/*.cl";

struct Shipped {
  std::string_view kind;
  Tuning tuning;
};

// Only what was measured on a device of the kind, against kdray's own choice, may be set here.
const Shipped kShipped[] = {{"cpu", {}}, {"gpu", {}}, {"accelerator", {}}};

}  // namespace

std::span<const Setting> settings() {
  static const std::vector<Setting> all = {
      {"batch", &Tuning::batch, {256, 1024, 2048}, "", true, false, "rays that a slice traces in one wave"},
      {"tile", &Tuning::tile, {16, 64}, "", true, true, "side of the largest tiles, pixels"},
      {"slices",
       &Tuning::slices,
       {4, 8, 16, 64},
       "",
       true,
       false,
       "slices in flight for each compute unit (block of the frame that one work-item renders)"},
      {"waves", &Tuning::waves, {16, 32, 128, 256}, "", true, false, "waves of a slice in one launch"},
      {"work-group",
       &Tuning::work_group,
       {16, 32, 64, 128, 256},
       "",
       false,
       true,
       "work-items in a group of the per-ray kernels"},
      {"prefetch",
       &Tuning::prefetch,
       {1, 2},
       kWalks,
       true,
       false,
       "rays and packets fetch their next node ahead: 1 no, 2 yes"},
      {"packets", &Tuning::packets, {4, 16}, kWalks, true, false, "packets of 16 rays in flight"},
      {"batch-rays", &Tuning::batch_rays, {16, 64}, kWalks, true, false, "single rays in flight"},
      {"spread",
       &Tuning::spread,
       {18, 70},
       kWalks,
       true,
       false,
       "directions that count as alike, percent of the largest component"},
      {"distance",
       &Tuning::distance,
       {10, 60},
       kWalks,
       true,
       false,
       "origins that count as near to begin with, thousandths of the world"}};
  return all;
}

const Setting* find_setting(std::string_view name) {
  const auto found = std::ranges::find(settings(), name, &Setting::name);
  return found == settings().end() ? nullptr : &*found;
}

Tuning shipped(std::string_view kind) {
  const auto found = std::ranges::find(kShipped, kind, &Shipped::kind);
  return found == std::end(kShipped) ? Tuning{} : found->tuning;
}

Tuning merged(const Tuning& under, const Tuning& over) {
  Tuning both = under;
  for (const Setting& s : settings())
    if (over.*s.value != 0) both.*s.value = over.*s.value;
  return both;
}

std::string in_words(const Tuning& tuning) {
  std::string words;
  for (const Setting& s : settings())
    if (tuning.*s.value != 0)
      words += fmt::format("{}{} {}", words.empty() ? "" : ", ", s.name, tuning.*s.value);
  return words.empty() ? "kdray's own" : words;
}

}  // namespace kdray::tuning
