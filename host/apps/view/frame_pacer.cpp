#include "apps/view/frame_pacer.h"

#include <algorithm>

namespace kdray::view {

void FramePacer::request(const Look& look) {
  look_ = look;
  step_ = 0;
}

std::optional<FramePacer::Work> FramePacer::next() const {
  if (!look_ || step_ == kDone || !can_send()) return std::nullopt;
  return Work{*look_, step_};
}

void FramePacer::finish(const Work& work, bool last) {
  if (!is_current(work)) return;
  step_ = last || work.look.moving ? kDone : work.step + 1;
}

std::uint32_t FramePacer::start_frame() {
  in_flight_.push_back(next_frame_);
  return next_frame_++;
}

bool FramePacer::acknowledge(std::uint32_t frame) {
  const auto found = std::ranges::find(in_flight_, frame);
  if (found == in_flight_.end()) return false;
  in_flight_.erase(found);
  return true;
}

namespace {

// A larger size needs some time to spare, so that the size doesn't change with every frame.
constexpr double kToSpare = 0.85;
constexpr double kNewest = 0.5;  // the share that the last frame has in what is known
constexpr double kCoarse = 4;    // times the target of adaptive samples, before the target itself
constexpr int kGuess = 4;
constexpr double kAnother = 1.5;    // times the pixels: another size
constexpr double kMostFixed = 0.7;  // the share of a frame that may be the same for every size
constexpr double kQuick = 0.5;      // of the time, what a frame takes that leaves room to try a larger one
constexpr int kMostPatience = 64;

}  // namespace

int ResolutionController::divide_by(double pixels) const {
  if (!known_) return kGuess;
  const int by = fitting(pixels);
  const bool as_last = !is_another(pixels / (by * by));
  return by > 1 && as_last && quick_frames_ >= patience_ ? by / 2 : by;
}

int ResolutionController::fitting(double pixels) const {
  for (const int by : {1, 2, 4}) {
    const double wanted = pixels / (by * by);
    const bool up = wanted > kAnother * last_pixels_;
    if (fixed_ + per_pixel_ * wanted <= kMovingSeconds * (up ? kToSpare : 1)) return by;
  }
  return 8;
}

bool ResolutionController::is_another(double pixels) const {
  return std::max(pixels, last_pixels_) > kAnother * std::min(pixels, last_pixels_);
}

void ResolutionController::record(double pixels, double seconds) {
  pixels = std::max(pixels, 1.0);
  const bool another = known_ && is_another(pixels);
  if (another) {
    const double slope = (seconds - last_seconds_) / (pixels - last_pixels_);
    fixed_ = std::max(0.0, seconds - slope * pixels);
    if (quick_frames_ >= patience_) patience_ = std::min(2 * patience_, kMostPatience);
  }
  quick_frames_ = !another && seconds < kQuick * kMovingSeconds ? quick_frames_ + 1 : 0;
  fixed_ = std::min(fixed_, kMostFixed * seconds);
  const double measured = (seconds - fixed_) / pixels;
  per_pixel_ = known_ && !another ? (1 - kNewest) * per_pixel_ + kNewest * measured : measured;
  known_ = true;
  last_pixels_ = pixels;
  last_seconds_ = seconds;
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
