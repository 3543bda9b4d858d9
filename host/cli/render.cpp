// What    kdray render: a scene file to a picture.
// Shape   Everything that can be refused is refused before the scene is read; the picture is written
//         whole or not at all, the statistics after it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "api/hooks.h"
#include "base/free_memory.h"
#include "base/timer.h"
#include "cli/command.h"
#include "cli/memory.h"
#include "cli/message.h"
#include "cli/open_scene.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/parse.h"
#include "cli/progress.h"
#include "cli/render_options.h"
#include "cli/run_files.h"
#include "cli/scene_input.h"
#include "cli/stats.h"
#include "cli/summary.h"
#include "cli/view_options.h"
#include "film/write.h"
#include "kdray/kdray.h"
#include "scene/scene.h"

namespace kdray::cli {

namespace {

namespace fs = std::filesystem;

struct RenderArgs {
  SceneInput scene;
  std::string output, stats, timeline;
  bool quiet = false, verbose = false;
  bool gamma_given = false, bits_given = false;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
  api::Hooks hooks;
  RenderOptions render;
  ViewOptions view;
  film::WriteOptions write;
};

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

void add_trace_options(CLI::App& app, RenderArgs& o) {
  const std::string group = "Division";
  add_path(app, "--trace", "Write what each queue did when, for Perfetto (Chrome trace format)", o.timeline)
      ->group(group);
  add_text(app, "--inject-fault", "Q@N", "For tests: the Nth launch on queue Q fails (Q@N,Q@N,...)",
           [&o](const std::string& text) { o.hooks.faults = text; })
      ->group(group);
}

// Before the scene is read. A name that isn't given depends on the files that the scene names.
void check_files(const RenderArgs& o, RunFiles& files) {
  check_scene_input(o.scene);
  if (o.view.transparent && o.render.adaptive_target > 0)
    throw Error(ErrorCode::usage,
                "--background transparent needs a number of --samples; adaptive ones don't look at coverage");
  files.read("SCENE", o.scene.file);
  files.write_picture("--output", o.output, o.render.channels, o.write);
  files.write("--stats", o.stats);
  files.write("--trace", o.timeline);
}

fs::path default_output(const RenderArgs& o) {
  return default_picture(o.scene.file, o.write.format.value_or(film::PictureFormat::png));
}

// Once it is known which files the scene names.
void check_files(RenderArgs& o, RunFiles& files, const scene::Scene& asked) {
  files.read_scene(asked.files);
  if (!o.output.empty()) return;
  const fs::path usual = default_output(o);
  o.output = files.free_name(usual, o.render.channels, o.write).string();
  files.write_picture("--output", o.output, o.render.channels, o.write);
  if (o.output != usual && !o.quiet)
    say(fmt::format("{} is a file that the scene names: the picture goes to {}", usual.string(), o.output));
}

bool makes_exr(const RenderArgs& o) {
  return o.write.format ? *o.write.format == film::PictureFormat::exr : ending_of(o.output) == ".exr";
}

void tell_of_options_without_effect(const RenderArgs& o) {
  if (o.quiet || !makes_exr(o)) return;
  if (o.gamma_given) say("--gamma has no effect: an EXR holds linear values");
  if (o.bits_given) say("--bits has no effect: an EXR holds floats");
}

// As the renderer will resolve it (RenderOptions::width).
void check_memory(const RenderArgs& o, const scene::RenderSettings& asked) {
  const RenderOptions& render = o.render;
  const int width = render.width > 0 ? render.width : asked.width.value_or(1024);
  const int height = render.height > 0 ? render.height : asked.height.value_or(1024);
  PictureNeeds picture{.width = static_cast<std::uint64_t>(width),
                       .height = static_cast<std::uint64_t>(height)};
  for (const std::string& name : render.channels) picture.n_channels += name == "normal" ? 3 : 1;
  if (o.view.transparent) ++picture.n_channels;
  picture.exr = makes_exr(o);
  picture.bits = o.write.png_bits;
  picture.adaptive = render.adaptive_target > 0;
  picture.n_queues = static_cast<std::uint64_t>(o.device.queues);
  check_picture_fits(picture, free_memory());
}

// Before a tree is built for nothing.
void check_view_of(const RenderArgs& o, const scene::Scene& asked) {
  if (o.view.any) check_view(asked, o.view.view);
}

// The picture's alpha, where it is wanted; the background is taken out of its colours then.
std::vector<float> make_transparent(Picture& picture, const PreparedScene& scene, const DeviceOptions& device,
                                    const RenderArgs& o) {
  if (!o.view.transparent) return {};
  std::vector<float> alpha = coverage(scene, device, o.render);
  const vec3& background = scene.settings().background;
  take_out_background(alpha, std::span<const float, 3>(&background.x, 3), picture.rgb);
  return alpha;
}

film::Image to_image(const Picture& picture) {
  film::Image image{picture.width, picture.height, std::vector<vec3>(picture.rgb.size() / 3)};
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  std::memcpy(image.pixels.data(), picture.rgb.data(), image.pixels.size() * sizeof(vec3));
  return image;
}

film::Written write(Picture&& picture, std::vector<float>&& alpha, const RenderArgs& o) {
  std::vector<film::Channel> channels;
  for (Channel& c : picture.channels) channels.push_back({std::move(c.name), std::move(c.values)});
  film::Image image = to_image(picture);
  image.alpha = std::move(alpha);
  picture.rgb = {};  // large pictures: no third copy while the file is made
  return put_picture(o.output, image, channels, o.write);
}

Picture render(Renderer& renderer, const RenderArgs& o) {
  Progress progress(o.quiet);
  RenderOptions options = o.render;
  options.timeline = !o.timeline.empty();
  options.progress = [&progress](double share) { progress.update(share); };
  return renderer.render(options);
}

int run(RenderArgs& o) {
  const Timer total;
  RunFiles files;
  check_files(o, files);
  tell_of_options_without_effect(o);
  o.tree.binary_form = takes_binary_form(o.render.traversal, o.render.precision, o.render.channels);
  OpenedScene scene(
      o.scene, o.tree, o.device, o.cache, o.quiet,
      [&](const scene::Scene& asked) {
        check_view_of(o, asked);
        check_files(o, files, asked);
        check_memory(o, asked.settings);
      },
      o.hooks);
  const PreparedScene seen =
      o.view.any ? scene.scene().seen(o.view.view, o.render.width, o.render.height) : scene.scene();
  Renderer renderer = api::make_renderer(seen, scene.device(), o.hooks);
  Picture picture = render(renderer, o);
  std::vector<float> alpha = make_transparent(picture, seen, scene.device(), o);
  if (!o.quiet)
    for (const std::string& warning : picture.warnings) say(warning);
  Statistics figures = renderer.statistics();
  const Timer step;
  const film::Written written = write(std::move(picture), std::move(alpha), o);
  figures.seconds.write = step.seconds();
  scene.keep();
  scene.add_to(figures.seconds);
  figures.seconds.total = total.seconds();

  Json stats = collect_stats("render", o.scene.file, figures);
  stats["cache"] = scene.cache();
  for (const auto& file : written.files) stats["files"].push_back(file.string());
  if (!o.stats.empty()) write_stats(o.stats, stats);
  if (!o.timeline.empty()) write_text(o.timeline, renderer.timeline() + "\n");
  if (!o.quiet) print_render_summary(stats, written.nan_values, o.verbose);
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
  add_trace_options(*app, *o);
  add_device_options(*app, o->device, o->render.traversal, o->render.precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
