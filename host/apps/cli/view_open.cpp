#include "apps/cli/view_open.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "base/temporary_folder.h"
#include "base/write_file.h"

extern char** environ;

namespace kdray::cli {

namespace {

bool has_hung_up(int descriptor) {
  pollfd polled{descriptor, 0, 0};
  return ::poll(&polled, 1, 0) > 0 && (polled.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != 0;
}

// Its own output is thrown away.
bool start(const char* program, const std::string& argument) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int descriptor : {0, 1, 2})
    posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C is not for it
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  char* const argv[] = {const_cast<char*>(program), const_cast<char*>(argument.c_str()), nullptr};
  pid_t child = -1;
  const int status = ::posix_spawnp(&child, program, &actions, &attributes, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (status != 0) return false;
  std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  return true;
}

}  // namespace

bool can_open() {
  return ::isatty(STDERR_FILENO) != 0 && (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")) &&
         !is_set("SSH_CONNECTION");
}

std::unique_ptr<Temporary> open_in_browser(const std::string& address) {
  std::unique_ptr<Temporary> folder = make_temporary_folder("kdray-page-");
  if (!folder) return nullptr;
  const std::filesystem::path file = folder->path() / "open.html";
  write_file(file,
             "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
             "<meta http-equiv=\"refresh\" content=\"0;url=" +
                 address + "\">\n");
  if (!start("xdg-open", file.string())) return nullptr;
  return folder;
}

StdioMonitor::StdioMonitor()
    : watches_in_(!has_hung_up(STDIN_FILENO)), watches_err_(!has_hung_up(STDERR_FILENO)) {}

bool StdioMonitor::is_closed() const {
  return (watches_in_ && has_hung_up(STDIN_FILENO)) || (watches_err_ && has_hung_up(STDERR_FILENO));
}

}  // namespace kdray::cli
