// What    kdray bench: the list of what there is to measure.
#include "bench/cli/commands.h"
#include "kdray/error.h"

namespace kdray::cli {

Command add_bench(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("bench", "Measure rays or frames, beside Embree and POV-Ray where they are");
  app->require_subcommand(0, 1);
  const Command rays = add_bench_rays(*app), queries = add_bench_queries(*app),
                frames = add_bench_frames(*app), build = add_bench_build(*app), depth = add_bench_depth(*app),
                modes = add_bench_modes(*app), accuracy = add_bench_accuracy(*app),
                ablation = add_bench_ablation(*app), instances = add_bench_instances(*app);
  return {app, [rays, queries, frames, build, depth, modes, accuracy, ablation, instances] {
            if (rays.app->parsed()) return rays.run();
            if (queries.app->parsed()) return queries.run();
            if (frames.app->parsed()) return frames.run();
            if (build.app->parsed()) return build.run();
            if (depth.app->parsed()) return depth.run();
            if (modes.app->parsed()) return modes.run();
            if (accuracy.app->parsed()) return accuracy.run();
            if (ablation.app->parsed()) return ablation.run();
            if (instances.app->parsed()) return instances.run();
            throw Error(ErrorCode::usage,
                        "what to bench is missing: rays, queries, frames, build, depth, modes, accuracy, "
                        "ablation, instances; see 'kdray "
                        "bench --help'");
          }};
}

}  // namespace kdray::cli
