// What    How large a picture is while the camera moves, so that it answers in time; and in which steps the
//         picture is made when it rests.
// Why     A frame takes what the scene, the view and the machine make it take: only the last ones tell. Part
//         of that time is the same for every size (launches, rays too far apart to be traced well), so a
//         frame of a fourth of the pixels takes more than a fourth of the time; two sizes tell how much more.
#pragma once

#include <vector>

#include "kdray/options.h"

namespace kdray::view {

// Wall time that a frame that moves may take on the server.
inline constexpr double kMovingSeconds = 0.040;

class ResolutionController {
 public:
  // 1, 2 or 4 (8, where even that is slow): by what width and height are to be divided.
  int divide_by(double pixels) const;
  // A frame of so many pixels took that long; also one at rest, with one sample for each pixel.
  void record(double pixels, double seconds);

 private:
  int fitting(double pixels) const;
  bool is_another(double pixels) const;  // size than the last one

  bool known_ = false;
  double fixed_ = 0, per_pixel_ = 0;  // seconds
  double last_pixels_ = 0, last_seconds_ = 0;
  // After so many quick frames in a row of one size the next larger one is tried, since what is known of that
  // may be of a moment when the machine had something else to do; each time after twice as many.
  int quick_frames_ = 0, patience_ = 4;
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
