// What    kdray bench frames: whole frames with the time of each stage, beside POV-Ray's.
// Shape   Tables go to stderr, each as soon as its scene is done; with --report DIR the figures go to
//         DIR/frames.json and a plot beside it.
#include <memory>
#include <string>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "bench/cli/bench_command.h"
#include "bench/cli/commands.h"
#include "bench/frames/bench.h"
#include "bench/povray/povray.h"

namespace kdray::cli {

namespace {

using FramesCommand = BenchCommand<bench::FramesOptions>;

int run(const FramesCommand& c) {
  require_scenes(c.options.scenes);
  if (!bench::has_povray()) say("povray is not installed: its times are left out");
  run_bench("frames", c.options, c.report, bench::bench_frames);
  return 0;
}

}  // namespace

Command add_bench_frames(CLI::App& bench) {
  CLI::App* const app =
      bench.add_subcommand("frames", "Whole frames with the time of each stage, Embree's and POV-Ray's");
  const auto c = std::make_shared<FramesCommand>();
  bench::FramesOptions& o = c->options;
  add_scenes(*app, o.scenes);
  add_picture_size(*app, kRaysMax, o.width, o.height);
  add_depth(*app, o.depth);
  add_no_embree(*app, o.embree);
  add_usual(*app, *c);
  return {app, [c] { return run(*c); }};
}

}  // namespace kdray::cli
