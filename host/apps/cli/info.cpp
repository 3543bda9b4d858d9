// What    kdray info: what a scene holds, the tree kdray builds for it, the memory both take. Needs no
//         device.
// Units   world units; bytes as held by this process; the tree's cost in units of its own constants.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "accel/kdtree/build.h"
#include "accel/kdtree/statistics.h"
#include "accel/prepare/prepared.h"
#include "accel/prepare/quality.h"
#include "accel/prepare/within.h"
#include "apps/cli/command.h"
#include "apps/cli/info_report.h"
#include "apps/cli/message.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/scene_input.h"
#include "base/peak_memory.h"
#include "base/timer.h"
#include "scene/model/geometry.h"

namespace kdray::cli {

namespace {

struct InfoArgs {
  SceneInput scene;
  TreeOptions tree;
  bool json = false;
};

// A tree and what a device gets of it, with the time that each took.
struct Forms {
  kdtree::Tree tree;
  flatten::FlatScene flat;
  flatten::WideForm wide;
  double build_seconds = 0, flatten_seconds = 0;

  std::size_t bytes() const { return flat.bytes() + wide.bytes(); }
};

Forms build_forms(const scene::Scene& scene, const scene::Geometry& geometry,
                  const kdtree::BuildConfig& config, bool binary_form) {
  Forms forms;
  Timer step;
  forms.tree = kdtree::build(geometry, config);
  forms.build_seconds = step.seconds();
  step.restart();
  forms.flat = flatten::flatten(scene, geometry, forms.tree, binary_form);
  forms.wide = flatten::make_wide(forms.tree, forms.flat, flatten::choose_block(forms.tree));
  forms.flatten_seconds = step.seconds();
  return forms;
}

// Both forms without a limit, which `info` tells of; with one, what `render` would make.
Forms build_forms_within(const scene::Scene& scene, const scene::Geometry& geometry,
                         const kdtree::BuildConfig& config, std::uint64_t most_bytes) {
  if (most_bytes == 0) return build_forms(scene, geometry, config, true);
  std::string warning;
  Forms forms = prepare::make_within(
      config, most_bytes,
      [&](const kdtree::BuildConfig& coarser) { return build_forms(scene, geometry, coarser, false); },
      warning);
  if (!warning.empty()) say(warning);
  return forms;
}

int run(const InfoArgs& o) {
  check_scene_input(o.scene);
  Timer step;
  const scene::Scene scene = load_model(o.scene);
  const double load_seconds = step.seconds();
  for (const std::string& warning : scene.warnings) say(warning);
  if (!scene.instances.empty())
    say(fmt::format("what is told is of the scene without its {} instances of {} meshes",
                    scene.instances.size(), scene.meshes.size()));

  step.restart();
  const scene::Geometry geometry = scene::make_geometry(scene);
  const double geometry_seconds = step.seconds();
  TreeOptions usual = o.tree;
  usual.binary_form = false;  // the tree that `render` makes
  const kdtree::BuildConfig config = prepare::config_of(usual, geometry.size());
  Forms forms;
  const std::uint64_t peak_before = peak_memory();  // measuring the next one makes the system forget it
  const std::optional<std::uint64_t> build_peak =
      peak_bytes_of([&] { forms = build_forms_within(scene, geometry, config, o.tree.memory_bytes); });

  Json report = scene_report(scene, geometry);
  report["tree"] = tree_report(kdtree::measure(forms.tree, geometry, config));
  report["tree"]["build"] = prepare::name_of(o.tree.quality);
  report["memory"] = memory_report({scene, geometry, forms.tree, forms.flat, forms.wide, build_peak,
                                    std::max(peak_before, peak_memory())});
  report["seconds"] = {{"load", load_seconds},
                       {"build", geometry_seconds + forms.build_seconds},
                       {"flatten", forms.flatten_seconds}};
  print(o.json ? report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n" : report_as_text(report));
  return 0;
}

}  // namespace

Command add_info(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("info", "Show counts, bounds, materials, tree statistics and memory of a scene");
  const auto o = std::make_shared<InfoArgs>();
  add_scene_input(*app, o->scene, "The scene, as for render");
  app->add_flag("--json", o->json, "Print JSON");
  add_tree_options(*app, o->tree);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
