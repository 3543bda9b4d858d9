// What    What a person sees while something takes time: a progress bar with the expected time left, redrawn
//         in one line of a terminal; and a notice that kernels are being compiled, once that has taken a
//         second: on a terminal a line that counts the seconds and goes away, elsewhere one line.
// Shape   The bar is silent when stderr is not a terminal or when told to be quiet; nothing of it stays on
//         the screen. Any thread may tell the notice that compiling begins or ends, and these may nest; a
//         thread of its own waits for the second to pass.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

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

class BuildNotice {
 public:
  // Without `draw`, `say` gets the line once. With it (on a terminal) the line is drawn again and again, and
  // cleared by an empty one.
  struct Output {
    std::function<void(const std::string&)> say;
    std::function<void(const std::string&)> draw;
    std::string text = "compiling kernels for this scene and device; later runs find them";
  };
  explicit BuildNotice(Output output, double patience_seconds = 1);
  ~BuildNotice();
  BuildNotice(const BuildNotice&) = delete;
  BuildNotice& operator=(const BuildNotice&) = delete;

  void tell(bool begins);
  void mute();  // for good

 private:
  void watch();

  Output output_;
  double patience_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int at_work_ = 0;
  bool ended_ = false;
  double spent_ = 0;  // before the work that is going on
  Timer since_begin_;
  std::thread thread_;  // the last member: it uses the others
};

// Returns whether kernels that are built now are there for later runs.
bool keeps_kernels();

// Returns functions that write the notice to stderr; none where `quiet`.
BuildNotice::Output notice_on_stderr(bool quiet);

}  // namespace kdray::cli
