#include "bench/accuracy/povray.h"

#include <fmt/format.h>

#include "bench/accuracy/settings.h"
#include "bench/accuracy/shown.h"

namespace kdray::bench {

namespace {

constexpr int kDeep = 16, kShallow = 5;
constexpr int kScale = 4;
constexpr double kSameModel = 0.1;  // of the error of one sample

PovraySetting setting(int method, const char* threshold, int grid) {
  const std::string m = fmt::format("+AM{}", method), a = fmt::format("+A{}", threshold),
                    r = fmt::format("+R{}", grid);
  return {fmt::format("{} {} {}", m, a, r), {m, a, r}, kDeep};
}

}  // namespace

// The settings go from what comes out of the box to what is nearly POV-Ray's reference: its default threshold
// is 0.3, its default grid 3.
std::vector<PovraySetting> povray_settings(bool quick) {
  if (quick) return {{"-A", {"-A"}, kDeep}, setting(2, "0.3", 3)};
  return {{"-A, depth 5", {"-A"}, kShallow},
          {"-A", {"-A"}, kDeep},
          setting(1, "0.3", 3),
          setting(1, "0.1", 3),
          setting(1, "0.03", 4),
          setting(2, "0.3", 3),
          setting(2, "0.1", 2),
          setting(2, "0.1", 3),
          setting(2, "0.1", 4),
          setting(2, "0.03", 3),
          setting(2, "0.03", 4)};
}

PovrayPoints::PovrayPoints(const scene::Scene& scene, const image::Image& reference,
                           const image::Image& plain, int threads, bool quick)
    : settings_(povray_settings(quick)), threads_(threads) {
  const int width = plain.width, height = plain.height;
  deep_ = std::make_unique<Povray>(scene, width, height, kDeep, kDefaultMinWeight);
  shallow_ = std::make_unique<Povray>(scene, width, height, kShallow, kDefaultMinWeight);
  model_difference_ = image::compare(plain, shown(deep_->trace(threads, {"-A"}).image));
  has_own_reference_ = model_difference_.rmse > kSameModel * image::compare(reference, plain).rmse;
  if (!has_own_reference_) {
    reference_ = reference;
    return;
  }
  const Povray large(scene, kScale * width, kScale * height, kDeep, 0);
  reference_ = shown(shrunk(large.trace(threads, {"+AM1", "+A0.0", "+R4"}).image, kScale));
}

Povray::Traced PovrayPoints::trace(std::size_t i) const {
  const PovraySetting& s = settings_[i];
  Povray::Traced traced = (s.depth == kDeep ? *deep_ : *shallow_).trace(threads_, s.flags);
  traced.image = shown(std::move(traced.image));
  return traced;
}

}  // namespace kdray::bench
