// What    Decides which frame of a page is rendered next: from the page's newest look, from how far the
//         picture of it is, and from the number of frames in flight; how large it is while the camera moves,
//         so that it comes in time; and in which steps the picture is made when the camera rests.
// Shape   While the camera moves, a frame for the newest look, as soon as one can be sent; at rest one step
//         after the other until the picture is final. At most kMaxInFlight frames are not acknowledged.
// Why     A frame's time depends on scene, view and machine: only recent frames tell it. Part of that time is
//         the same for every size (launches, rays too far apart to be traced well), so a frame of a fourth of
//         the pixels takes more than a fourth of the time; two sizes tell how much more.
// Threads One at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "apps/view/message.h"
#include "kdray/options.h"

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

  // Returns the next work, if there is any and a frame can be sent.
  std::optional<Work> next() const;
  // Notes that the work is done, or has failed. `last`: nothing is left to do for this look.
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

// The wall time that a frame may take on the server while the camera moves.
inline constexpr double kMovingSeconds = 0.040;

class ResolutionController {
 public:
  // Returns by what to divide width and height: 1, 2 or 4 (8, where even that is slow).
  int divide_by(double pixels) const;
  // Notes how long a frame of so many pixels took; also one at rest, if it had one sample for each pixel.
  void record(double pixels, double seconds);

 private:
  int fitting(double pixels) const;
  bool is_another(double pixels) const;  // whether `pixels` is another size than the last frame's

  bool known_ = false;
  double fixed_ = 0, per_pixel_ = 0;  // seconds
  double last_pixels_ = 0, last_seconds_ = 0;
  // After so many quick frames of one size in a row the next larger size is tried, since the machine may have
  // been busy when that was last measured; each time after twice as many.
  int quick_frames_ = 0, patience_ = 4;
};

// A picture on the way to the final one.
struct Step {
  int samples = 0;             // 0: as the finished picture has them
  double adaptive_target = 0;  // 0: as the finished picture has it
  bool last = false;
};

// Returns the steps to the picture that is wanted, which is the last of them. All have the full size.
std::vector<Step> steps_to(const RenderOptions& wanted);

// Returns the options of that step.
RenderOptions options_of(const Step& step, RenderOptions wanted);

}  // namespace kdray::view
