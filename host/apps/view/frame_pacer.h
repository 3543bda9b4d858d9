// What    Decides which frame of a page is rendered next: from the page's newest look, from how far the
//         picture of it is, and from the number of frames in flight.
// Shape   While the camera moves, a frame for the newest look, as soon as one can be sent; at rest one step
//         after the other until the picture is final. At most kMaxInFlight frames are not acknowledged.
// Threads One at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "apps/view/message.h"

namespace kdray::view {

inline constexpr std::size_t kMaxInFlight = 2;

class FramePacer {
 public:
  struct Work {
    Look look;
    std::size_t step = 0;  // at rest
  };

  void request(const Look& look);
  // The scene has changed: renders the newest look anew.
  void restart() { step_ = 0; }

  // The next work, if there is any and a frame can be sent.
  std::optional<Work> next() const;
  // The work is done, or has failed. `last`: nothing is left of this look.
  void finish(const Work& work, bool last);

  // Whether the work is for the newest look.
  bool is_current(const Work& work) const { return look_ && look_->number == work.look.number; }

  std::uint32_t start_frame();            // the number of a frame that is about to be sent
  bool acknowledge(std::uint32_t frame);  // false: no such frame is in flight
  bool can_send() const { return in_flight_.size() < kMaxInFlight; }

 private:
  static constexpr std::size_t kDone = SIZE_MAX;

  std::optional<Look> look_;
  std::size_t step_ = kDone;
  std::uint32_t next_frame_ = 1;
  std::vector<std::uint32_t> in_flight_;
};

}  // namespace kdray::view
