// What    How large a picture is while the camera moves, so that it answers in time; and in which steps the
//         picture is made when it rests.
// Why     A frame takes what the scene, the view and the machine make it take: only the last one tells.
#pragma once

#include <vector>

#include "kdray/options.h"

namespace kdray::view {

// Wall time that a frame that moves may take on the server.
inline constexpr double kMovingSeconds = 0.045;

class Ladder {
 public:
  // 1, 2 or 4 (8, where even that is slow): by what width and height are to be divided.
  int divide_by(double pixels) const;
  // A frame of so many pixels took that long.
  void took(double pixels, double seconds);
  // Something else is to be rendered now: what is known of times may be wrong.
  void forget() { known_ = false; }

 private:
  bool known_ = false;
  double seconds_per_pixel_ = 0;
  int last_ = 4;
};

// A picture on the way to the final one.
struct Step {
  int samples = 0;             // 0: as the finished picture has them
  double adaptive_target = 0;  // 0: as the finished picture has it
  bool last = false;
};

// All of full size; the last one is the picture that `wanted` is.
std::vector<Step> steps_to(const RenderOptions& wanted);

// The options of that step.
RenderOptions options_of(const Step& step, RenderOptions wanted);

}  // namespace kdray::view
