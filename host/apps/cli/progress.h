// What    A progress bar with the expected time left, redrawn in one line of a terminal.
// Shape   Silent when stderr is not a terminal or when told to be quiet; nothing of it stays on the
//         screen.
#pragma once

#include "base/timer.h"

namespace kdray::cli {

class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(double share);  // 0 to 1
  void clear();

 private:
  bool shown_here_;
  bool drawn_ = false;
  Timer since_start_, since_draw_;
};

}  // namespace kdray::cli
