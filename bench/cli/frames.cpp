// What    kdray bench frames: whole frames with the time of each stage, beside POV-Ray's.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/frames.json and a plot beside it.
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/commands.h"
#include "bench/cli/limits.h"
#include "bench/cli/report_files.h"
#include "bench/frames/bench.h"
#include "bench/povray/povray.h"

namespace kdray::cli {

namespace {

struct FramesCommand {
  bench::FramesOptions options;
  std::string report;
};

int run(const FramesCommand& c) {
  require_scenes(c.options.scenes);
  prepare_report(c.report, "frames");
  say_without_embree();
  if (!bench::has_povray()) say("povray is not installed: its times are left out");
  const auto frames = bench::bench_frames(
      c.options, [](const bench::FrameResult& frame) { print_table(bench::table_of(frame)); },
      [](const std::string& what) { say(what); });
  write_report(c.report, "frames", bench::json_of(frames, c.options));
  return 0;
}

}  // namespace

Command add_bench_frames(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("frames", "Whole frames with the time of each stage, and POV-Ray's");
  const auto c = std::make_shared<FramesCommand>();
  bench::FramesOptions& o = c->options;
  add_scenes(*app, o.scenes, "balls gears mount rings teapot tetra tree");
  add_size(*app, "Pixels across and down (default 1024x1024)", kSideMax, kRaysMax, o.width, o.height);
  add_int(*app, "--depth", "Deepest ray; the eye ray is 1 (default 5)", 1, 64, o.depth);
  add_int(*app, "--repeat", "Rounds to take the median of (default 7)", 1, kRepeatMax, o.repeat);
  add_device_option(*app, "The device, as for render (default: auto)", o.device);
  add_report(*app, c->report);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
