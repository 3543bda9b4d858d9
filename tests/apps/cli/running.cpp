#include "apps/cli/running.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <utility>

namespace kdray::test {

Running::Running(const std::vector<std::string>& arguments, const std::string& log,
                 const std::string& program, const std::map<std::string, std::string>& environment)
    : process_(::fork()) {
  if (process_ < 0) throw std::runtime_error("fork failed");
  if (process_ > 0) return;
  ::setenv("KDRAY_CACHE_DIR", "", 1);  // no test uses the cache of the user who runs it
  for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  const int in = ::open("/dev/null", O_RDONLY),
            err = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  ::dup2(in, 0), ::dup2(err, 1), ::dup2(err, 2);
  std::vector<char*> argv{const_cast<char*>("kdray")};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  ::execv(program.empty() ? KDRAY_PROGRAM : program.c_str(), argv.data());
  ::_exit(127);
}

Running::~Running() {
  if (process_ <= 0 || has_ended()) return;
  kill(SIGKILL);
  wait();
}

Running::Running(Running&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      ended_(other.ended_),
      code_(other.code_),
      signal_(other.signal_) {}

void Running::kill(int signal) const {
  if (!ended_) ::kill(process_, signal);
}

bool Running::has_ended() {
  int status = 0;
  if (ended_ || ::waitpid(process_, &status, WNOHANG) != process_) return ended_;
  ended_ = true;
  if (WIFEXITED(status)) code_ = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) signal_ = WTERMSIG(status);
  return true;
}

bool Running::wait(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  while (!has_ended() && Clock::now() < until) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return ended_;
}

std::vector<pid_t> Running::children() const {
  const std::string id = std::to_string(process_);
  std::ifstream stream("/proc/" + id + "/task/" + id + "/children");
  std::vector<pid_t> all;
  for (pid_t child = 0; stream >> child;) all.push_back(child);
  return all;
}

}  // namespace kdray::test
