// What    The timelines of a scene's frames below each other, as SVG: what each queue of each scheme did and
//         when.
// Shape   From Renderer::timeline() (Chrome trace format). All frames of a scene share one axis, so that what
//         a division leaves idle is seen as white.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/modes/bench.h"

namespace kdray::bench {

struct TimelineSpan {
  int queue = 0;
  std::string name;
  double start = 0, end = 0;  // in seconds since the frame's first span began
};

// Returns the spans in the order of the queues and of time. Throws Error (internal) for what is no timeline.
std::vector<TimelineSpan> spans_of(const std::string& chrome_trace);

// Empty where no row has a timeline.
std::string timeline_svg(std::span<const ModesRun> runs, const ModesOptions& options);

}  // namespace kdray::bench
