// What    kdray bench: measures rays, or whole frames, against the other ray tracers that are there.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/rays.json or DIR/frames.json and a plot beside it.
// Errors  Hits that differ between kdray's traversals: exit code 1, after everything has been written.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "bench/embree.h"
#include "bench/kdray_contestants.h"
#include "bench/povray.h"
#include "bench/rays.h"
#include "bench/rays_bench.h"
#include "bench/report.h"
#include "cli/bench_ablation.h"
#include "cli/bench_accuracy.h"
#include "cli/bench_build.h"
#include "cli/bench_limits.h"
#include "cli/bench_modes.h"
#include "cli/bench_report.h"
#include "cli/command.h"
#include "cli/message.h"
#include "cli/options.h"
#include "cli/parse.h"

namespace kdray::cli {

namespace {

constexpr int kCoresMax = 4096;

struct FramesCommand {
  bench::FramesOptions options;
  std::string report;
};

struct RaysCommand {
  bench::RaysOptions options;
  std::string report;
};

int run_rays(const RaysCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "rays");
  if (c.options.embree) say_without_embree();
  const auto runs = bench::bench_rays(
      c.options, [](const bench::RaysRun& run) { print_table(bench::table_of(run)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "rays", bench::json_of(runs, c.options), bench::plot_of(runs, c.options));
  if (const std::size_t n = bench::count_not_identical(runs); n > 0)
    throw Error(ErrorCode::internal,
                fmt::format("{} hits of kdray's traversals are not identical to the binary one's", n));
  return 0;
}

int run_frames(const FramesCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "frames");
  say_without_embree();
  if (!bench::has_povray()) say("povray is not installed: its times are left out");
  const auto frames = bench::bench_frames(
      c.options, [](const bench::FrameResult& frame) { print_table(bench::table_of(frame)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "frames", bench::json_of(frames, c.options), bench::plot_of(frames, c.options));
  return 0;
}

// "1,all": numbers of cores, 0 for all.
std::vector<int> parse_cores(const std::string& text) {
  std::vector<int> cores;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string item = text.substr(start, comma - start);
    cores.push_back(item == "all" ? 0 : parse_int("--cores", item, 1, kCoresMax));
    start = comma + 1;
  }
  return cores;
}

Command add_rays(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("rays", "The same rays through every traversal, and through Embree");
  const auto c = std::make_shared<RaysCommand>();
  bench::RaysOptions& o = c->options;
  add_scenes(*app, o.scenes, "boxes spheres balls rings");
  add_text(
      *app, "--classes", "LIST", "Of primary,scanline,shadow,mirror,refracted,diffuse,random (default: all)",
      [&o](const std::string& text) { o.classes = parse_list("--classes", text, bench::class_names()); });
  add_text(*app, "--traversals", "LIST", "Of binary,wide,packet,batch,auto (default: all)",
           [&o](const std::string& text) {
             o.traversals = parse_list("--traversals", text, bench::traversal_names());
           });
  add_int(*app, "--rays", "Rays of a class, as a square picture holds them (default 1048576)", 1, kRaysMax,
          o.rays);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_text(*app, "--cores", "LIST", "Numbers of cores, or all (default 1,all; on a GPU all)",
           [&o](const std::string& text) { o.cores = parse_cores(text); });
  app->add_flag_callback(
      "--no-embree", [&o] { o.embree = false; }, "Leave Embree out: kdray's traversals against each other");
  add_report(*app, c->report);
  return {app, [c] { return run_rays(*c); }};
}

Command add_frames(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("frames", "Whole frames with the time of each stage, and POV-Ray's");
  const auto c = std::make_shared<FramesCommand>();
  bench::FramesOptions& o = c->options;
  add_scenes(*app, o.scenes, "balls gears mount rings teapot tetra tree");
  add_size(*app, "Pixels across and down (default 1024x1024)", kSideMax, kRaysMax, o.width, o.height);
  add_int(*app, "--depth", "Deepest ray; the eye ray is 1 (default 5)", 1, 64, o.depth);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_report(*app, c->report);
  return {app, [c] { return run_frames(*c); }};
}

}  // namespace

Command add_bench(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("bench", "Measure rays or frames, beside Embree and POV-Ray where they are");
  app->require_subcommand(0, 1);
  const Command rays = add_rays(*app), frames = add_frames(*app), build = add_bench_build(*app),
                depth = add_bench_depth(*app), modes = add_bench_modes(*app),
                accuracy = add_bench_accuracy(*app), ablation = add_bench_ablation(*app);
  return {app, [rays, frames, build, depth, modes, accuracy, ablation] {
            if (rays.app->parsed()) return rays.run();
            if (frames.app->parsed()) return frames.run();
            if (build.app->parsed()) return build.run();
            if (depth.app->parsed()) return depth.run();
            if (modes.app->parsed()) return modes.run();
            if (accuracy.app->parsed()) return accuracy.run();
            if (ablation.app->parsed()) return ablation.run();
            throw Error(
                ErrorCode::usage,
                "what to bench is missing: rays, frames, build, depth, modes, accuracy, ablation; see 'kdray "
                "bench --help'");
          }};
}

}  // namespace kdray::cli
