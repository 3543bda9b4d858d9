// What    A program run as a child process, for as long as it may take and no longer, which reports on a pipe
//         of its own.
// Shape   The child inherits the environment, with some variables set anew, and no signal blocked; it reads
//         nothing, and what it writes to stdout and stderr is lost: drivers chatter there. It leads a process
//         group of its own, which is killed as a whole, so that what it has started goes with it.
// Errors  None are thrown: a program that can't be started is an end like any other.
// Threads Any; a Child serves one at a time. The thread that starts it has to live as long as it: with that
//         thread the child is killed (live_as_child_of).
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/timer.h"

namespace kdray {

struct ChildEnd {
  bool started = true;
  bool timed_out = false;   // it was killed
  int signal = 0;           // the signal that it died of; 0: it didn't, or this can't be known
  int status = -1;          // its exit status; -1: it has none
  std::string report = {};  // what it wrote to kReport, as far as it came
};

struct ChildOptions {
  std::filesystem::path program;
  std::vector<std::string> arguments = {};
  std::map<std::string, std::string> environment = {};  // set on top of this process' own
  // From the start on. Time in which the machine's cores were all taken by others doesn't count: what a busy
  // machine keeps waiting doesn't hang. But kMostPatience times as long ends it in any case.
  double limit_seconds = 15;
};

class Child {
 public:
  static constexpr int kReport = 3;  // the descriptor that the child reports on
  static constexpr double kMostPatience = 8;

  explicit Child(const ChildOptions& options);  // starts it
  ~Child();                                     // kills it, if need be; leaves no zombie
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Waits for its end, or kills it when its time is over.
  const ChildEnd& wait();

 private:
  bool start(const ChildOptions& options, int report);
  void read_report(int milliseconds);
  bool has_ended();
  bool is_late() const;
  void kill_group() const;
  void reap();

  pid_t process_ = -1;  // -1: there is none, or none any more
  int report_ = -1;
  double limit_, idle_at_start_;  // seconds
  Timer since_start_;
  ChildEnd end_;
};

// Makes this program end with `parent`, the process that started it as a Child, and leave no core file behind
// when it crashes. A child calls this before all else.
void live_as_child_of(pid_t parent);

// Returns "SIGSEGV" for 11, "signal 99" for a signal without a name.
std::string signal_name(int signal);

}  // namespace kdray
