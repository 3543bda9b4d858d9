// What    kdray view: looks around in scenes, in the browser.
// Shape   Everything that can be refused is refused before a scene is read.
#include <filesystem>
#include <memory>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/render_options.h"
#include "apps/cli/scene_input.h"
#include "apps/cli/view_args.h"

namespace kdray::cli {

namespace {

void check(const ViewArgs& args) {
  if (args.view.transparent)
    throw Error(ErrorCode::usage, "--background transparent is for pictures; give view a colour");
  for (const std::string& scene : args.scenes) {
    if (scene == "-")
      throw Error(ErrorCode::usage,
                  "view reads files, again when they change; standard input can't be read again");
    if (!std::filesystem::exists(scene)) throw Error(ErrorCode::input, scene + ": no such file");
  }
}

int run(ViewArgs& args) {
  check(args);
  return show_page(args);
}

void add_page_options(CLI::App& app, ViewArgs& o) {
  const std::string group = "Page";
  add_int(app, "--port", "Where the page is served (default: 7878, or the next one that is free)", 1, 65535,
          o.port)
      ->group(group);
  add_text(app, "--bind", "ADDRESS",
           "The machine's address, in numbers, to listen at (default: 127.0.0.1 alone)",
           [&o](const std::string& text) { o.bind = text; })
      ->group(group);
  CLI::Option* const open =
      app.add_flag("--open", o.open, "Open the page in the browser (default: where there is a screen)")
          ->group(group);
  app.add_flag("--no-open", o.no_open, "Only print the page's address")->group(group)->excludes(open);
  add_real(app, "--linger", "SECONDS", "End so long after the last page was closed (default 120); 0: stay", 0,
           1e7, o.linger)
      ->group(group);
}

}  // namespace

Command add_view(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("view", "Look around in a scene, in the browser");
  const auto o = std::make_shared<ViewArgs>();
  app->add_option("SCENE", o->scenes,
                  "The scene, or several: .nff .obj .ply .stl .gltf .glb .json, also .gz and .xz")
      ->required()
      ->type_name("");
  add_page_options(*app, *o);
  add_load_options(*app, o->load);
  add_loudness(*app, o->quiet, o->verbose);
  add_picture_options(*app, o->render);
  add_view_options(*app, o->view);
  add_division_options(*app, o->render);
  add_device_options(*app, o->device, o->render.traversal, o->render.precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  show_most_used_first(*app);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
