// What    kdray render: a scene to a picture, or to the pictures of a sequence.
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "apps/cli/command.h"
#include "apps/cli/parse.h"
#include "apps/cli/ranks.h"
#include "apps/cli/render_frame.h"
#include "apps/cli/render_options.h"
#include "apps/cli/restarts.h"
#include "apps/cli/sequence.h"

namespace kdray::cli {

namespace {

void add_file_options(CLI::App& app, RenderArgs& o) {
  static constexpr std::array<std::string_view, 2> kBits = {"8", "16"};
  static constexpr std::array<std::string_view, 7> kChannels = {"depth", "normal", "primitive", "instance",
                                                                "cost",  "queue",  "samples"};
  add_path(app, "-o,--output",
           "The picture, .png or .exr; '-': standard output (default: the scene's name with .png, here)",
           o.output);
  add_picture_format(app, o.write.format);
  add_text(app, "--gamma", "G", "PNG's transfer curve: srgb (default) or v^(1/G)",
           [&o](const std::string& text) {
             o.write.transfer = parse_gamma("--gamma", text);
             o.gamma_given = true;
           });
  add_text(app, "--bits", "N", "Bits per channel of a PNG: 8 (default) or 16", [&o](const std::string& text) {
    o.write.png_bits = parse_choice("--bits", text, kBits) == "16" ? 16 : 8;
    o.bits_given = true;
  });
  add_text(app, "--aov", "LIST",
           "More channels, in the EXR or as files beside the PNG: "
           "depth,normal,primitive,instance,cost,queue,samples",
           [&o](const std::string& text) { o.render.channels = parse_list("--aov", text, kChannels); });
  add_path(app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o.stats);
  add_loudness(app, o.quiet, o.verbose);
}

void add_trace_options(CLI::App& app, RenderArgs& o) {
  const std::string group = "Division";
  add_path(app, "--trace", "Write what each queue did when, for Perfetto (Chrome trace format)", o.timeline)
      ->group(group);
  add_text(app, "--inject-fault", "Q@N", "For tests: the Nth launch on queue Q fails (Q@N,Q@N,...)",
           [&o](const std::string& text) { o.hooks.faults = text; })
      ->group(group);
}

int run(RenderArgs& o) {
  check_checkpoint(o);
  check_ranks(o);
  if (ranks_of_this_run()) {
    o.hooks.ranks = ranks_of_this_run();
    o.hooks.faults = faults_of_rank(o.hooks.faults, o.hooks.ranks->rank());
    o.quiet = o.quiet || !leads();
  }
  if (o.checkpoint.restarts > 0) return run_again(o.checkpoint);
  if (o.checkpoint.frames) return render_sequence(o);
  o.render.ledger = o.checkpoint.options();
  FrameMaker(o).make(o);
  return 0;
}

}  // namespace

Command add_render(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("render", "Render a scene to a picture");
  const auto o = std::make_shared<RenderArgs>();
  add_scene_input(
      *app, o->scene,
      "The scene: .nff .obj .ply .stl .gltf .glb .json, also .gz and .xz of them; '-': standard input");
  add_file_options(*app, *o);
  add_view_options(*app, o->view);
  add_picture_options(*app, o->render);
  add_division_options(*app, o->render);
  add_ranks_options(*app, o->hold);
  add_trace_options(*app, *o);
  add_checkpoint_options(*app, o->checkpoint);
  add_device_options(*app, o->device, o->render.traversal, o->render.precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
