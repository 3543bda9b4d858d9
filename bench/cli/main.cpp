// What    kdray-bench, the program that `kdray bench` starts: `kdray-bench rays` does what `kdray bench rays`
//         is to do.
// Shape   Its command line is kdray's with the one command: help and messages are the same whoever asks.
#include <span>
#include <vector>

#include "apps/cli/help.h"
#include "bench/cli/bench_command.h"
#include "kdray/error.h"

namespace {

using kdray::cli::Command;

Command add_bench(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("bench", "Measure rays or frames, beside Embree and POV-Ray where they are");
  app->require_subcommand(0, 1);
  using namespace kdray::cli;
  const std::vector<Command> all = {
      add_bench_rays(*app),     add_bench_queries(*app),  add_bench_frames(*app),
      add_bench_build(*app),    add_bench_depth(*app),    add_bench_modes(*app),
      add_bench_accuracy(*app), add_bench_ablation(*app), add_bench_instances(*app)};
  return {app, [all] {
            for (const Command& command : all)
              if (command.app->parsed()) return command.run();
            throw kdray::Error(kdray::ErrorCode::usage,
                               "what to bench is missing: rays, queries, frames, build, depth, modes, "
                               "accuracy, ablation, instances; see 'kdray bench --help'");
          }};
}

}  // namespace

int main(int argc, char** argv) {
  return kdray::cli::run_program([&] {
    CLI::App app;
    kdray::cli::prepare(app);
    const Command commands[] = {add_bench(app)};
    const CLI::App* const pages[] = {commands[0].app};
    if (kdray::cli::answer_shells(app, pages, {argv, static_cast<std::size_t>(argc)})) return 0;
    std::vector<const char*> arguments = {"kdray", "bench"};
    if (argc > 1) arguments.insert(arguments.end(), argv + 1, argv + argc);
    return kdray::cli::parse_and_run(app, arguments, commands);
  });
}
