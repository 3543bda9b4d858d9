// What    The commands of `kdray bench` (apps/cli/command.h), and what every one does: its options, tables to
//         stderr, each as soon as a scene is done, and with --report DIR the figures in DIR/<name>.json and a
//         plot beside them, which the script kdray-bench-plot beside the program draws (bench/plot).
// Errors  ErrorCode::input for a folder that can't be made or written, before anything is measured. What has
//         to be 0 and isn't: exit code 1, after everything has been written.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "base/text.h"
#include "bench/measure/progress.h"
#include "bench/measure/report.h"

namespace kdray::cli {

Command add_bench_rays(CLI::App& bench);
Command add_bench_queries(CLI::App& bench);
Command add_bench_frames(CLI::App& bench);
Command add_bench_build(CLI::App& bench);
Command add_bench_depth(CLI::App& bench);
Command add_bench_modes(CLI::App& bench);
Command add_bench_accuracy(CLI::App& bench);
Command add_bench_ablation(CLI::App& bench);
Command add_bench_instances(CLI::App& bench);

// The most that options may ask for.
inline constexpr int kRaysMax = 1 << 26;  // of a class
inline constexpr int kRepeatMax = 100000;
inline constexpr int kCoresMax = 4096;
inline constexpr int kSideMax = 65536;  // of a picture, across or down
inline constexpr long long kPixelsMax = 1 << 26;

template <class Options>
struct BenchCommand {
  Options options;
  std::string report;  // the folder; empty: none
};

// ---- Options; the defaults in their help are the values that they have.

void add_scenes(CLI::App& app, std::vector<std::string>& scenes);
void add_scenes(CLI::App& app, std::vector<std::string>& scenes, const std::string& default_scenes);
void add_rays(CLI::App& app, int& rays);  // of a class
void add_depth(CLI::App& app, int& depth);
void add_picture_size(CLI::App& app, long long pixels_max, int& width, int& height);
void add_no_embree(CLI::App& app, bool& embree);
void add_repeat_and_device(CLI::App& app, int& repeat, std::string& device);
void add_report(CLI::App& app, std::string& report);

// A list of values with commas between, each read by parse(name, text).
template <class T, class Parse>
void add_values(CLI::App& app, const std::string& name, const std::string& help, std::vector<T>& values,
                const Parse& parse) {
  add_text(app, name, "LIST", help, [&values, name, parse](const std::string& text) {
    values.clear();
    for (const std::string& part : split_list(text)) values.push_back(parse(name, part));
  });
}

// Adds a command with its options, and those that all have.
template <class Command_>
Command add_command(CLI::App& bench, const std::string& name, const std::string& what,
                    void (*add_options)(CLI::App&, Command_&), int (*run)(const Command_&)) {
  CLI::App* const app = bench.add_subcommand(name, what);
  const auto c = std::make_shared<Command_>();
  add_options(*app, *c);
  add_repeat_and_device(*app, c->options.repeat, c->options.device);
  add_report(*app, c->report);
  return {app, [c, run] { return run(*c); }};
}

// ---- Running.

// Throws for a name that is neither a file's nor a built-in scene's: before the first scene is measured.
void require_scenes(const std::vector<std::string>& scenes);
void make_folder(const std::filesystem::path& folder);
// A folder for the report, made before anything is measured; nothing where there is to be none.
void prepare_report(const std::string& folder, const std::string& name);
// Where no plot can be drawn, a line says why; the figures are there all the same.
void write_report(const std::string& folder, const std::string& name, const bench::Json& json);

void print_table(const std::string& table);
void say_working(const std::string& what);
void say_without_embree();
// Throws that there are so many, where there are any.
void require_none(std::size_t n, const std::string& what);

// Does one of bench/: run by run, with its table, and then the report.
template <class Options, class Run>
std::vector<Run> run_bench(const std::string& name, const Options& options, const std::string& report,
                           std::vector<Run> (*bench)(const Options&, const bench::Progress<Run>&)) {
  prepare_report(report, name);
  if constexpr (requires { options.embree; })
    if (options.embree) say_without_embree();
  const auto done = [&](const Run& run) {
    if constexpr (requires { table_of(run, options); })
      print_table(table_of(run, options));
    else
      print_table(table_of(run));
  };
  std::vector<Run> runs = bench(options, {done, say_working});
  write_report(report, name, json_of(runs, options));
  return runs;
}

}  // namespace kdray::cli
