// What    kdray-bench, the program that `kdray bench` starts: `kdray-bench rays` does what `kdray bench rays`
//         is to do.
// Shape   Its command line is kdray's with the one command: help and messages are the same whoever asks.
#include <span>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/help.h"
#include "bench/cli/commands.h"

int main(int argc, char** argv) {
  return kdray::cli::run_program([&] {
    CLI::App app;
    kdray::cli::prepare(app);
    const kdray::cli::Command commands[] = {kdray::cli::add_bench(app)};
    const CLI::App* const pages[] = {commands[0].app};
    if (kdray::cli::answer_shells(app, pages, {argv, static_cast<std::size_t>(argc)})) return 0;
    std::vector<const char*> arguments = {"kdray", "bench"};
    if (argc > 1) arguments.insert(arguments.end(), argv + 1, argv + argc);
    return kdray::cli::parse_and_run(app, arguments, commands);
  });
}
