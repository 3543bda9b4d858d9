// What    kdray render: a scene to a picture, or to the pictures of a sequence.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "cli/command.h"
#include "cli/parse.h"
#include "cli/render_frame.h"
#include "cli/restarts.h"
#include "cli/sequence.h"

namespace kdray::cli {

namespace {

constexpr int kPictureSideMax = 65536;
// 16384 x 16384; memory.h refuses what this machine can't hold.
constexpr long long kPicturePixelsMax = 1ll << 28;

void add_picture_options(CLI::App& app, RenderArgs& o) {
  add_size(app, "Pixels across and down (default: the scene's, or 1024x1024)", kPictureSideMax,
           kPicturePixelsMax, o.render.width, o.render.height);
  add_int(app, "--depth", "Deepest ray; the eye ray is 1 (default: the scene's, or 5)", 1, 64,
          o.render.depth);
  add_real(app, "--min-weight", "W",
           "Rays of less weight are not traced (default: what can't change an 8-bit picture); 0: trace all",
           0, 1, o.render.min_weight);
  add_text(app, "--samples", "N|adaptive[:TARGET]",
           "Rays per pixel, stratified (default: the scene's, or 1); or as many where they are needed as an "
           "RMSE of "
           "TARGET takes (default 0.0075)",
           [&o](const std::string& text) {
             const Samples samples = parse_samples("--samples", text);
             o.render.samples = samples.number, o.render.adaptive_target = samples.target;
           });
  static constexpr std::array<std::string_view, 2> kGrids = {"centers", "corners"};
  add_text(app, "--grid", "NAME",
           "centers: rays through the pixels' centers; corners: the outermost rays go through the picture's "
           "corners, "
           "as the counts published for the SPD scenes are made",
           [&o](const std::string& text) {
             const bool corners = parse_choice("--grid", text, kGrids) == "corners";
             o.render.grid = corners ? PixelGrid::corners : PixelGrid::centers;
           });
}

void add_file_options(CLI::App& app, RenderArgs& o) {
  static constexpr std::array<std::string_view, 2> kBits = {"8", "16"};
  static constexpr std::array<std::string_view, 5> kChannels = {"depth", "normal", "primitive", "cost",
                                                                "samples"};
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
           "More channels, in the EXR or as files beside the PNG: depth,normal,primitive,cost,samples",
           [&o](const std::string& text) { o.render.channels = parse_list("--aov", text, kChannels); });
  add_path(app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o.stats);
  add_loudness(app, o.quiet, o.verbose);
}

// Adds an option that takes one of an enumeration's names, in the order of its values.
template <class Choice, std::size_t kN>
void add_choice(CLI::App& app, const std::string& option, const std::string& help,
                const std::array<std::string_view, kN>& names, Choice& choice) {
  add_text(app, option, "NAME", help, [option, &names, &choice](const std::string& text) {
    parse_choice(option, text, names);
    choice = static_cast<Choice>(std::find(names.begin(), names.end(), text) - names.begin());
  })->group("Division");
}

void add_division_options(CLI::App& app, RenderArgs& o) {
  static constexpr std::array<std::string_view, 3> kModes = {"auto", "pdprt", "odprt"};
  static constexpr std::array<std::string_view, 3> kDivisions = {"bag", "contiguous", "interleaved"};
  static constexpr std::array<std::string_view, 3> kBalances = {"sah", "pilot", "dynamic"};
  const std::string group = "Division";
  add_choice(app, "--mode", "What queues divide among them: pdprt the pixels, odprt the scene; auto chooses",
             kModes, o.render.mode);
  add_choice(app, "--division", "How pdprt's queues come by tiles: bag (default), contiguous, interleaved",
             kDivisions, o.render.division);
  add_choice(app, "--balance", "What odprt's subtrees are dealt out by: sah, pilot (default), dynamic",
             kBalances, o.render.balance);
  add_text(app, "--tile", "WxH", "Size of the tiles the picture is divided into (default: chosen)",
           [&o](const std::string& text) {
             const Size size = parse_size("--tile", text, kPictureSideMax, kPicturePixelsMax);
             o.render.tile_width = size.width, o.render.tile_height = size.height;
           })
      ->group(group);
  add_int(app, "--ray-buffer", "Rays in a buffer between two of odprt's queues, per slice (default: chosen)",
          1, 1 << 20, o.render.ray_buffer)
      ->group(group);
  add_text(app, "--device-memory", "BYTES",
           "The most that a device may hold, as in 500M: odprt's subtrees come and go",
           [&o](const std::string& text) { o.render.device_memory = parse_bytes("--device-memory", text); })
      ->group(group);
  add_path(app, "--trace", "Write what each queue did when, for Perfetto (Chrome trace format)", o.timeline)
      ->group(group);
  add_text(app, "--inject-fault", "Q@N", "For tests: the Nth launch on queue Q fails (Q@N,Q@N,...)",
           [&o](const std::string& text) { o.hooks.faults = text; })
      ->group(group);
}

int run(RenderArgs& o) {
  check_ledger(o);
  if (o.ledger.restarts > 0) return run_again(o.ledger);
  if (o.ledger.frames) return render_sequence(o);
  o.render.ledger = o.ledger.options();
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
  add_picture_options(*app, *o);
  add_division_options(*app, *o);
  add_ledger_options(*app, o->ledger);
  add_device_options(*app, o->device, o->render.traversal, o->render.precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
