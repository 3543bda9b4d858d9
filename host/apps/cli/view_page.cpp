// What    kdray view's page: opens the first scene, says where the page is, serves it until it is ended.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>

#include "apps/cli/message.h"
#include "apps/cli/open_scene.h"
#include "apps/cli/output.h"
#include "apps/cli/view_args.h"
#include "apps/cli/view_open.h"
#include "apps/view/address.h"
#include "apps/view/server.h"
#include "apps/view/view_service.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

SceneInput input_of(const ViewArgs& args, const std::string& scene) {
  SceneInput input;
  input.file = scene;
  input.load = args.load;
  return input;
}

std::vector<view::SceneSource> sources_of(const ViewArgs& args) {
  std::vector<view::SceneSource> sources;
  for (const std::string& scene : args.scenes) {
    const auto open = [&args, scene] {
      OpenedScene opened(input_of(args, scene), args.tree, args.device, args.cache, true);
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
  OpenedScene first(input_of(args, args.scenes.front()), args.tree, args.device, args.cache, args.quiet,
                    [&args](const scene::Scene& asked) {
                      if (args.view.any) check_view(asked, args.view.view);
                    });
  first.keep();
  view::Settings settings{args.view.view, args.render, first.device(), args.load};
  view::ViewService service(sources_of(args), settings, {first.scene(), {}});
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
