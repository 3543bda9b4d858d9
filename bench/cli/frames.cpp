// What    The commands that render whole frames. bench frames: with the time of each stage, beside Embree's
//         and POV-Ray's. bench ablation: what each specialisation and each rule of skipping is worth.
#include "apps/cli/output.h"
#include "bench/ablation/bench.h"
#include "bench/cli/bench_command.h"
#include "bench/frames/bench.h"
#include "bench/povray/povray.h"

namespace kdray::cli {

namespace {

using FramesCommand = BenchCommand<bench::FramesOptions>;
using AblationCommand = BenchCommand<bench::AblationOptions>;

int run_frames(const FramesCommand& c) {
  require_scenes(c.options.scenes);
  if (!bench::has_povray()) say("povray is not installed: its times are left out");
  run_bench("frames", c.options, c.report, bench::bench_frames);
  return 0;
}

void add_frames_options(CLI::App& app, FramesCommand& c) {
  bench::FramesOptions& o = c.options;
  add_scenes(app, o.scenes);
  add_picture_size(app, kRaysMax, o.width, o.height);
  add_depth(app, o.depth);
  add_no_embree(app, o.embree);
}

int run_ablation(const AblationCommand& c) {
  require_scenes(c.options.scenes);
  const auto runs = run_bench("ablation", c.options, c.report, bench::bench_ablation);
  require_none(bench::count_inexact(runs), "pictures changed where none may");
  return 0;
}

void add_ablation_options(CLI::App& app, AblationCommand& c) {
  bench::AblationOptions& o = c.options;
  add_scenes(app, o.scenes);
  add_picture_size(app, kPixelsMax, o.width, o.height);
  add_depth(app, o.depth);
  app.add_option("--only", o.only, "Take away these alone, by their names in the table")
      ->type_name("NAME...");
}

}  // namespace

Command add_bench_frames(CLI::App& bench) {
  return add_command(bench, "frames", "Whole frames with the time of each stage, Embree's and POV-Ray's",
                     add_frames_options, run_frames);
}

Command add_bench_ablation(CLI::App& bench) {
  return add_command(bench, "ablation",
                     "What each specialisation and each rule of skipping is worth: one at a time off",
                     add_ablation_options, run_ablation);
}

}  // namespace kdray::cli
