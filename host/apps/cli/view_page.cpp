// What    kdray view's page: opens the first scene, says where the page is, opens it in the user's browser,
//         and serves it until it is ended, or until the terminal or pipe is closed by which the user could
//         see or end the server.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "apps/cli/open_scene.h"
#include "apps/cli/output.h"
#include "apps/cli/view_args.h"
#include "apps/view/http.h"
#include "apps/view/server.h"
#include "apps/view/view_service.h"
#include "base/temporary.h"
#include "base/write_file.h"
#include "scene/model/scene.h"

extern char** environ;

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

SceneInput input_of(const std::string& scene, const LoadOptions& load) {
  SceneInput input;
  input.file = scene;
  input.load = load;
  return input;
}

std::vector<view::SceneSource> sources_of(const ViewArgs& args) {
  std::vector<view::SceneSource> sources;
  for (const std::string& scene : args.scenes) {
    const auto open = [&args, scene](const LoadOptions& load) {
      OpenedScene opened(input_of(scene, load), args.tree, args.device, args.cache, true);
      opened.keep();
      return view::LoadedScene{opened.scene(), {}};
    };
    sources.push_back({fs::path(scene).filename().string(), scene, open});
  }
  return sources;
}

std::string user_at_host() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {"HOST"};
  const char* const user = std::getenv("USER");
  return fmt::format("{}@{}", user != nullptr ? user : "USER", host.data());
}

void say_where(const ViewArgs& args, const view::Server& server) {
  print(server.address() + "\n");
  if (args.quiet) return;
  if (view::is_loopback(args.bind))
    say(fmt::format("from another machine: ssh -L {0}:{1}:{0} {2}, then open that address there",
                    server.port(), view::in_brackets(args.bind), user_at_host()));
  else
    say(fmt::format(
        "warning: the page is served at {}, not to this machine alone, and nothing of it is encrypted: who "
        "reads the network's traffic can look, too; ssh -L is safe",
        args.bind));
  say(args.linger > 0
          ? fmt::format("Ctrl-C ends this, and so does closing the page, after {} s (--linger)", args.linger)
          : std::string("Ctrl-C ends this"));
}

bool has_hung_up(int descriptor) {
  pollfd polled{descriptor, 0, 0};
  return ::poll(&polled, 1, 0) > 0 && (polled.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != 0;
}

// Starts a program, whose output is thrown away.
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

// Returns whether there is a screen here, and a user at a terminal.
bool can_open() {
  return ::isatty(STDERR_FILENO) != 0 && (is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")) &&
         !is_set("SSH_CONNECTION");
}

// Opens the address by way of a file that only this user can read: everybody can see the command lines of
// programs, and the address has the token. The file is removed with what is returned; null: there is no
// program that opens pages.
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

// Tells whether standard input or standard error has been closed, where it led to a terminal or a pipe at
// first.
class StdioMonitor {
 public:
  StdioMonitor();
  bool is_closed() const;

 private:
  bool watches_in_, watches_err_;
};

StdioMonitor::StdioMonitor()
    : watches_in_(!has_hung_up(STDIN_FILENO)), watches_err_(!has_hung_up(STDERR_FILENO)) {}

bool StdioMonitor::is_closed() const {
  return (watches_in_ && has_hung_up(STDIN_FILENO)) || (watches_err_ && has_hung_up(STDERR_FILENO));
}

}  // namespace

int show_page(ViewArgs& args) {
  const StdioMonitor stdio;
  const view::ServerOptions options{
      .bind = args.bind,
      .port = args.port,
      .linger = std::chrono::milliseconds(static_cast<long long>(args.linger * 1000)),
      .is_over = [&stdio] { return stdio.is_closed(); }};
  view::Server server(options);  // before the scene is read: the port may be taken
  args.tree.binary_form = true;  // channels and cells are of it
  OpenedScene first(input_of(args.scenes.front(), args.load), args.tree, args.device, args.cache, args.quiet,
                    [&args](const scene::Scene& asked) { check_view_of(args.view, asked); });
  first.keep();
  view::Settings settings{args.view.view,
                          args.render,
                          first.device(),
                          args.load,
                          args.view.look.value_or(Look::studio),
                          asks_for_studio(args.view)};
  view::LoadedScene loaded{first.scene(), {}};
  const PreparedScene shown = in_look(first.scene(), args.view);
  if (settings.look == Look::studio) loaded.studio = shown;
  if (!args.quiet) tell_of_view(shown, args.view);
  view::ViewService service(sources_of(args), settings, std::move(loaded));
  say_where(args, server);
  std::unique_ptr<Temporary> opened;
  if (args.open || (!args.no_open && can_open())) {
    opened = open_in_browser(server.address());
    if (!opened) say("there is no xdg-open here: open the address in a browser");
  }
  server.run(service);
  if (!args.quiet) say("no page is open any more");
  return 0;
}

}  // namespace kdray::cli
