#include "apps/cli/restarts.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "apps/cli/message.h"
#include "base/child.h"
#include "base/error.h"

namespace kdray::cli {

namespace {

// Of this process, without --restarts.
std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> arguments;
  for (std::size_t at = 0; at < all.size(); at = all.find('\0', at) + 1) {
    const std::string argument = all.c_str() + at;
    if (argument == "--restarts")
      at = all.find('\0', at) + 1;  // and its value
    else if (!argument.starts_with("--restarts="))
      arguments.push_back(argument);
  }
  return arguments;
}

// In the child: only what is safe while other threads are lost.
[[noreturn]] void become(char* const* arguments, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(1);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execv("/proc/self/exe", arguments);
  ::_exit(127);
}

int run_once(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(pointers.data(), parent);
  if (child < 0)
    throw Error(ErrorCode::internal, fmt::format("no process for the run ({})", std::strerror(errno)));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

bool is_on_purpose(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT;
}

}  // namespace

int run_again(const CheckpointChoice& choice) {
  std::vector<std::string> arguments = own_arguments();
  for (int left = choice.restarts;; --left) {
    const int status = run_once(arguments);
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    const int signal = WTERMSIG(status);
    if (is_on_purpose(signal) || left == 0) {
      say(fmt::format("the run was ended by {}{}; what is finished is in {}", signal_name(signal),
                      is_on_purpose(signal) ? "" : ", and it was the last that --restarts allows",
                      choice.folder()));
      return 1;
    }
    say(fmt::format("the run was ended by {}; it goes on from {} ({} more {})", signal_name(signal),
                    choice.folder(), left - 1, left == 2 ? "restart" : "restarts"));
    if (choice.share.empty() && std::ranges::find(arguments, "--resume") == arguments.end())
      arguments.push_back("--resume");
  }
}

}  // namespace kdray::cli
