#include "apps/view/guest.h"

#include <algorithm>

namespace kdray::view {

void Guest::ask(const Look& look) {
  look_ = look;
  step_ = 0;
}

std::optional<Guest::Work> Guest::next() const {
  if (!look_ || step_ == kDone || !can_take()) return std::nullopt;
  return Work{*look_, step_};
}

void Guest::done(const Work& work, bool last) {
  if (!wants(work)) return;
  step_ = last || work.look.moving ? kDone : work.step + 1;
}

std::uint32_t Guest::send() {
  on_the_way_.push_back(next_frame_);
  return next_frame_++;
}

bool Guest::shown(std::uint32_t frame) {
  const auto found = std::ranges::find(on_the_way_, frame);
  if (found == on_the_way_.end()) return false;
  on_the_way_.erase(found);
  return true;
}

}  // namespace kdray::view
