#include "apps/cli/program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "support/patience.h"

namespace kdray::test {

namespace {

using Clock = std::chrono::steady_clock;

// A file without a name: no pipe that could fill up while nobody reads it.
class Capture {
 public:
  Capture() : file_(std::tmpfile()) {
    if (!file_) throw std::runtime_error("no temporary file");
  }
  ~Capture() { std::fclose(file_); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  int descriptor() const { return ::fileno(file_); }
  std::string text() const {
    std::rewind(file_);
    std::string text;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, file_)) text.append(buffer, n);
    return text;
  }

 private:
  std::FILE* file_;
};

[[noreturn]] void become_kdray(const std::vector<std::string>& arguments, const RunOptions& options, int out,
                               int err) {
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(127);
  ::setenv("KDRAY_CACHE_DIR", "", 1);  // no test uses the cache of the user who runs it
  for (const auto& [name, value] : options.environment) ::setenv(name.c_str(), value.c_str(), 1);
  if (!options.stdout_file.empty())
    out = ::open(options.stdout_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (const rlim_t limit = options.limit_address_space; limit > 0) {
    const rlimit address_space{limit, limit};
    ::setrlimit(RLIMIT_AS, &address_space);
  }
  const int in = ::open(options.stdin_file.empty() ? "/dev/null" : options.stdin_file.c_str(), O_RDONLY);
  ::dup2(in, 0), ::dup2(out, 1), ::dup2(err, 2);
  std::vector<char*> argv{const_cast<char*>("kdray")};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  ::execv(options.program.empty() ? KDRAY_PROGRAM : options.program.c_str(), argv.data());
  ::_exit(127);
}

// Waits in small steps, so that a child that hangs can be killed.
void wait_for(pid_t child, const RunOptions& options, Outcome& run) {
  const Clock::time_point start = Clock::now();
  int status = 0;
  rusage usage{};
  bool killed = false, signalled = options.signal == 0;
  while (::wait4(child, &status, WNOHANG, &usage) == 0) {
    run.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (!signalled && options.signal_when()) ::kill(child, options.signal), signalled = true;
    if (run.seconds > kPatience && !killed) ::kill(child, SIGKILL), killed = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  run.exited = WIFEXITED(status);
  run.code = run.exited ? WEXITSTATUS(status) : -1;
  run.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  run.peak_kib = usage.ru_maxrss;
}

}  // namespace

std::string without_notice(std::string err) {
  const std::size_t at = err.find("kdray: compiling kernels");
  if (at != std::string::npos) err.erase(at, err.find('\n', at) + 1 - at);
  return err;
}

Outcome kdray(const std::vector<std::string>& arguments, const RunOptions& options) {
  const Capture out, err;
  Outcome run;
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_kdray(arguments, options, out.descriptor(), err.descriptor());
  wait_for(child, options, run);
  run.out = out.text();
  run.err = err.text();
  return run;
}

::testing::AssertionResult fails_with(const Outcome& run, int code, const std::string& text) {
  const auto no = [&run](const std::string& why) {
    return ::testing::AssertionFailure() << why << "; exit code " << run.code << ", signal " << run.signal
                                         << ", stderr: " << run.err << ", stdout: " << run.out;
  };
  if (!run.exited || run.code != code) return no("not exit code " + std::to_string(code));
  if (!run.out.empty()) return no("something on stdout");
  const std::string err = without_notice(run.err);
  if (std::count(err.begin(), err.end(), '\n') != 1 || err.back() != '\n') return no("not one line");
  if (err.rfind("kdray: ", 0) != 0) return no("not from kdray");
  if (err.find(text) == std::string::npos) return no("'" + text + "' is not said");
  return ::testing::AssertionSuccess();
}

::testing::AssertionResult succeeds(const Outcome& run) {
  if (run.exited && run.code == 0) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "exit code " << run.code << ", signal " << run.signal << ", stderr: " << run.err;
}

bool has_device() {
  static const bool has = kdray({"devices"}).code == 0;
  return has;
}

bool has_bench() {
  return std::filesystem::exists(std::filesystem::path(KDRAY_PROGRAM).replace_filename("kdray-bench"));
}

}  // namespace kdray::test
