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

}  // namespace kdray::view
