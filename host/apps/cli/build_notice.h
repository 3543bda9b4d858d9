// What    Tells that kernels are being compiled, once that has taken a second: on a terminal a line that
//         counts the seconds and goes away, elsewhere one line.
// Shape   begins and ends are told from any thread and may nest; a thread of its own waits for the second to
//         pass.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "base/timer.h"

namespace kdray::cli {

class BuildNotice {
 public:
  // Without `draw` the line is said once; with it (a terminal) it is drawn again and again, and cleared by an
  // empty one.
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

// The notice goes to stderr.
BuildNotice::Output notice_on_stderr(bool quiet);

}  // namespace kdray::cli
