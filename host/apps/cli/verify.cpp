// What    kdray verify: whether a scene's mesh is sound, and whether kdray traces it soundly.
// Errors  A mesh with holes is a finding, not an error: exit code 0. 1 when kdray itself went wrong, or for a
//         file that can't be read.
#include "apps/verify/verify.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/progress.h"
#include "apps/cli/run_files.h"
#include "apps/cli/scene_input.h"
#include "apps/cli/stats.h"
#include "apps/cli/verify_report.h"
#include "base/error.h"
#include "base/timer.h"
#include "io/image/picture_file.h"

namespace kdray::cli {

namespace {

struct VerifyArgs {
  SceneInput scene;
  std::string output, stats;
  image::WriteOptions write;
  int width = 1280, height = 720, rays = 1 << 18;
  bool quiet = false;
  TreeOptions tree;
  DeviceOptions device;
};

void check_options(const VerifyArgs& o, RunFiles& files) {
  check_scene_input(o.scene);
  files.read("SCENE", o.scene.file);
  files.write_picture("--output", o.output, {}, o.write);
  files.write("--stats", o.stats);
  if (o.width < verify::kLeastWidth || o.height < verify::kLeastHeight)
    throw Error(ErrorCode::usage, fmt::format("--size {}x{}: the picture needs {}x{} at least", o.width,
                                              o.height, verify::kLeastWidth, verify::kLeastHeight));
}

Json stats_of(const VerifyArgs& o, const verify::Findings& found, double load, double total) {
  const verify::Seconds& s = found.seconds;
  Json stats = {{"kdray", KDRAY_VERSION}, {"command", "verify"}, {"scene", {{"file", o.scene.file}}}};
  primitives::for_each_kind(
      [&](auto kind) { stats["scene"][kind.kNames] = decltype(kind)::of(found.counts); });
  stats.update(findings_as_json(found));
  stats["seconds"] = {
      {"load", load},       {"build", s.build}, {"mesh", s.mesh},       {"duplicates", s.duplicates},
      {"probes", s.probes}, {"film", s.film},   {"picture", s.picture}, {"total", total}};
  stats["memory"] = {{"process_peak_bytes", peak_memory()}};
  return stats;
}

void tell(const VerifyArgs& o, const verify::Findings& found, double load, double total) {
  const verify::Seconds& s = found.seconds;
  std::string text = findings_in_words(found);
  text += fmt::format(
      "       time              load {}, build {}, mesh {}, duplicates {}, rays {}, film {}; {} in all\n",
      seconds_in_words(load), seconds_in_words(s.build), seconds_in_words(s.mesh),
      seconds_in_words(s.duplicates), seconds_in_words(s.probes), seconds_in_words(s.film),
      seconds_in_words(total));
  if (const std::string colors = verify::colors_of(found); !o.output.empty())
    text += fmt::format("       picture           {}{}{}\n", o.output, colors.empty() ? "" : "; ", colors);
  std::fputs(text.c_str(), stderr);
}

int run(const VerifyArgs& o) {
  const Timer total;
  RunFiles files;
  check_options(o, files);
  DeviceOptions device = o.device;
  if (!o.quiet) device.left_out = [](const std::string& why) { say(why); };
  open_device(device);
  Timer step;
  const scene::Scene scene = load_model(o.scene);
  files.read_scene(scene.files);
  const double load = step.seconds();
  if (!o.quiet)
    for (const std::string& warning : scene.warnings) say(warning);

  Progress progress(o.quiet);
  verify::Options options{.rays = static_cast<std::uint64_t>(o.rays), .tree = o.tree, .device = o.device};
  if (!o.output.empty()) options.width = o.width, options.height = o.height;
  options.progress = [&](double share) { progress.update(share); };
  const verify::Findings found = verify::verify(scene, options);
  progress.clear();

  if (!o.output.empty()) put_picture(o.output, found.picture, {}, o.write);
  if (!o.stats.empty()) write_stats(o.stats, stats_of(o, found, load, total.seconds()));
  if (!o.quiet) tell(o, found, load, total.seconds());
  if (!o.quiet || !found.kdray_is_sound()) say(scene.name + ": " + verdict(found));
  return found.kdray_is_sound() ? 0 : static_cast<int>(ErrorCode::input);
}

}  // namespace

Command add_verify(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand(
      "verify", "Check a scene's mesh, and that kdray traces it without leaks and self-hits");
  const auto o = std::make_shared<VerifyArgs>();
  add_scene_input(*app, o->scene, "The scene, as for render");
  add_path(*app, "-o,--output", "A picture of where the findings are, .png or .exr; '-': standard output",
           o->output);
  add_picture_format(*app, o->write.format);
  add_size(*app, "Pixels of that picture (default 1280x720)", 16384, 1 << 26, o->width, o->height);
  add_int(*app, "--rays", "Rays to send, besides those that leave their hits (default 262144)", 1, 2000000000,
          o->rays);
  add_path(*app, "--stats", "Write the findings as JSON ('-': to standard output)", o->stats);
  app->add_flag("-q,--quiet", o->quiet, "Say nothing unless kdray went wrong");
  add_device_option(*app, "As for render; one device", o->device.device);
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
