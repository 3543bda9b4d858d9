// What    What a page is owed: the newest sight that it asked for, how far the picture of it is, and how many
//         frames are on the way.
// Shape   While the camera moves, a frame for the newest sight, as soon as one can be sent; at rest one step
//         after the other until the picture is final. At most kMostOnTheWay frames are not acknowledged.
// Threads One at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "apps/view/ladder.h"
#include "apps/view/message.h"

namespace kdray::view {

inline constexpr std::size_t kMostOnTheWay = 2;

class Guest {
 public:
  struct Work {
    Look look;
    std::size_t step = 0;  // at rest
  };

  void ask(const Look& look);
  // The scene has changed: what was asked for is to be rendered anew.
  void begin_anew() { step_ = 0; }

  // What is to be rendered next, if anything is.
  std::optional<Work> next() const;
  // It is done, or can't be: `last` says that nothing is left of this look.
  void done(const Work& work, bool last);

  // Whether it still wants what was begun for it.
  bool wants(const Work& work) const { return look_ && look_->number == work.look.number; }

  std::uint32_t send();             // the number of a frame that is about to be sent
  bool shown(std::uint32_t frame);  // false: no such frame is on the way
  bool can_take() const { return on_the_way_.size() < kMostOnTheWay; }

 private:
  static constexpr std::size_t kDone = SIZE_MAX;

  std::optional<Look> look_;
  std::size_t step_ = kDone;
  std::uint32_t next_frame_ = 1;
  std::vector<std::uint32_t> on_the_way_;
};

}  // namespace kdray::view
