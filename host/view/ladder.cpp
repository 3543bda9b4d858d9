#include "view/ladder.h"

#include <algorithm>

namespace kdray::view {

namespace {

// Up goes who has some time to spare, so that the size doesn't change with every frame.
constexpr double kToSpare = 0.75;
constexpr double kNewest = 0.5;  // the share that the last frame has in what is known
constexpr double kCoarse = 4;    // times the target of adaptive samples, before the target itself
constexpr int kGuess = 4;

}  // namespace

int Ladder::divide_by(double pixels) const {
  if (!known_) return kGuess;
  for (const int by : {1, 2, 4}) {
    const double seconds = seconds_per_pixel_ * pixels / (by * by);
    if (seconds <= kMovingSeconds * (by < last_ ? kToSpare : 1)) return by;
  }
  return 8;
}

void Ladder::took(double pixels, double seconds) {
  const double measured = seconds / std::max(pixels, 1.0);
  seconds_per_pixel_ = known_ ? (1 - kNewest) * seconds_per_pixel_ + kNewest * measured : measured;
  known_ = true;
}

std::vector<Step> steps_to(const RenderOptions& wanted) {
  if (!wanted.channels.empty()) return {{.last = true}};
  if (wanted.adaptive_target > 0)
    return {{.samples = 1}, {.adaptive_target = kCoarse * wanted.adaptive_target}, {.last = true}};
  if (wanted.samples == 1) return {{.last = true}};
  return {{.samples = 1}, {.last = true}};
}

RenderOptions options_of(const Step& step, RenderOptions wanted) {
  if (step.samples > 0) wanted.samples = step.samples, wanted.adaptive_target = 0;
  if (step.adaptive_target > 0) wanted.adaptive_target = step.adaptive_target;
  return wanted;
}

}  // namespace kdray::view
