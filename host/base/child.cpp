#include "base/child.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>
#include <thread>

namespace kdray {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// How often a child that keeps its pipe open is looked at, and how long one may take to end after SIGKILL: a
// call into a graphics driver that hangs in the kernel can't be ended at all.
constexpr milliseconds kStep{20}, kLastPatience{1000};
constexpr std::size_t kLongestReport = 1 << 16;

// Returns this process' environment, with these variables in place of its own.
std::vector<std::string> environment_with(const std::map<std::string, std::string>& set) {
  std::vector<std::string> all;
  for (char** variable = environ; variable && *variable; ++variable) {
    const std::string_view text = *variable;
    if (!set.contains(std::string(text.substr(0, text.find('='))))) all.emplace_back(text);
  }
  for (const auto& [name, value] : set) all.push_back(name + "=" + value);
  return all;
}

// Returns what exec takes: pointers, and a null behind them.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// Returns the seconds for which the cores that this process may use have had nothing to do since the machine
// started, summed over them; infinite where the system doesn't say.
double idle_seconds() {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  const bool is_known = ::sched_getaffinity(0, sizeof mine, &mine) == 0;  // not over 1024 cores
  std::ifstream in("/proc/stat");
  double sum = 0;
  bool any = false;
  for (std::string line; std::getline(in, line) && line.starts_with("cpu");) {
    std::istringstream fields(line.substr(3));
    int core = 0;
    double user = 0, nice = 0, system = 0, idle = 0, waiting = 0;
    if (line[3] == ' ' || !(fields >> core >> user >> nice >> system >> idle >> waiting)) continue;
    if (is_known && !CPU_ISSET(core, &mine)) continue;
    sum += (idle + waiting) / static_cast<double>(::sysconf(_SC_CLK_TCK));
    any = true;
  }
  return any ? sum : std::numeric_limits<double>::infinity();
}

// Returns the seconds of a core that the process has used, with those of its children that have ended.
double used_seconds(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(in, text);
  std::istringstream fields(
      text.substr(std::min(text.rfind(')') + 1, text.size())));  // a name may have blanks
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double user = 0, system = 0, childrens_user = 0, childrens_system = 0;
  fields >> user >> system >> childrens_user >> childrens_system;
  return (user + system + childrens_user + childrens_system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

// What is done in the child before the program begins.
class Preparations {
 public:
  explicit Preparations(int report) {
    ::posix_spawn_file_actions_init(&files_);
    ::posix_spawnattr_init(&attributes_);
    ::posix_spawn_file_actions_adddup2(&files_, report, Child::kReport);  // first: it may be one of 0 to 2
    ::posix_spawn_file_actions_addopen(&files_, 0, "/dev/null", O_RDONLY, 0);
    for (const int lost : {1, 2}) ::posix_spawn_file_actions_addopen(&files_, lost, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
    ::posix_spawn_file_actions_addclosefrom_np(&files_, Child::kReport + 1);
#endif
    sigset_t none;
    sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  }
  ~Preparations() {
    ::posix_spawn_file_actions_destroy(&files_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  Preparations(const Preparations&) = delete;
  Preparations& operator=(const Preparations&) = delete;

  const posix_spawn_file_actions_t* files() const {
    return &files_;
  }
  const posix_spawnattr_t* attributes() const {
    return &attributes_;
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

}  // namespace

Child::Child(const ChildOptions& options) : limit_(options.limit_seconds), idle_at_start_(idle_seconds()) {
  int pipe[2];
  end_.started = ::pipe2(pipe, O_CLOEXEC) == 0;
  if (!end_.started) return;
  report_ = pipe[0];
  ::fcntl(report_, F_SETFL, O_NONBLOCK);
  end_.started = start(options, pipe[1]);
  ::close(pipe[1]);
}

bool Child::start(const ChildOptions& options, int report) {
  const Preparations preparations(report);
  std::vector<std::string> arguments = {options.program.string()};
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  std::vector<std::string> environment = environment_with(options.environment);
  if (::posix_spawn(&process_, options.program.c_str(), preparations.files(), preparations.attributes(),
                    pointers_to(arguments).data(), pointers_to(environment).data()) == 0)
    return true;
  process_ = -1;
  return false;
}

Child::~Child() {
  if (process_ > 0) {
    kill_group();
    reap();
  }
  if (report_ >= 0) ::close(report_);
}

const ChildEnd& Child::wait() {
  while (process_ > 0) {
    if (has_ended()) {
      read_report(0);
      kill_group();  // what it has left behind
      reap();
      break;
    }
    if (is_late()) {
      end_.timed_out = true;
      kill_group();
      reap();
      break;
    }
    read_report(static_cast<int>(kStep.count()));
  }
  return end_;
}

// Waits so long for bytes or for the end of the pipe; where the pipe has ended already, a millisecond at
// most.
void Child::read_report(int most_milliseconds) {
  if (report_ < 0) return std::this_thread::sleep_for(milliseconds(std::min(most_milliseconds, 1)));
  pollfd waiting{report_, POLLIN, 0};
  if (::poll(&waiting, 1, most_milliseconds) <= 0) return;
  char bytes[4096];
  for (ssize_t n = 0; (n = ::read(report_, bytes, sizeof bytes)) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return;  // no more for now
    if (end_.report.size() < kLongestReport) end_.report.append(bytes, static_cast<std::size_t>(n));
  }
  ::close(report_);
  report_ = -1;
}

// The child stays a zombie for the moment, so that no other group can get its number. Where this program
// ignores SIGCHLD, or waits for every child elsewhere, nothing can be known of its end.
bool Child::has_ended() {
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(process_), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
    return errno != EINTR;
  if (info.si_pid == 0) return false;
  (info.si_code == CLD_EXITED ? end_.status : end_.signal) = info.si_status;
  return true;
}

// Counts the time in which the child ran, and in which it could have run since a core was idle.
bool Child::is_late() const {
  const double elapsed = since_start_.seconds();
  if (elapsed < limit_) return false;
  const double idle = idle_seconds();
  return std::isinf(idle) || idle - idle_at_start_ + used_seconds(process_) >= limit_ ||
         elapsed >= kMostPatience * limit_;
}

void Child::kill_group() const {
  ::kill(-process_, SIGKILL);
}

void Child::reap() {
  const Clock::time_point patience = Clock::now() + kLastPatience;
  pid_t reaped = 0;
  while ((reaped = ::waitpid(process_, nullptr, WNOHANG)) == 0 || (reaped < 0 && errno == EINTR)) {
    if (Clock::now() > patience) break;
    std::this_thread::sleep_for(milliseconds(1));
  }
  process_ = -1;
}

void live_as_child_of(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it has ended before that
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
}

std::string signal_name(int signal) {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 32)
  if (const char* const name = ::sigabbrev_np(signal)) return std::string("SIG") + name;
#endif
  return "signal " + std::to_string(signal);
}

}  // namespace kdray
