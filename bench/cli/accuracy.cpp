// What    kdray bench accuracy: time against error of every setting, beside POV-Ray's antialiasing.
// Shape   To the folder "accuracy" in that of the report go the references and where each picture differs
//         from them. All of it as soon as a scene is done: a reference may take an hour, and a run that is
//         stopped keeps the scenes before.
#include <fmt/format.h>

#include "apps/cli/output.h"
#include "bench/accuracy/bench.h"
#include "bench/accuracy/exact.h"
#include "bench/accuracy/shown.h"
#include "bench/cli/bench_command.h"
#include "bench/povray/povray.h"
#include "io/image/picture_file.h"

namespace kdray::cli {

namespace {

constexpr int kReferenceSideMax = 16384, kSamplesMax = 65536;
constexpr long long kReferencePixelsMax = 1 << 24;  // a reference takes 16 times as many
constexpr const char* kName = "accuracy";

using AccuracyCommand = BenchCommand<bench::AccuracyOptions>;

int run(const AccuracyCommand& c) {
  for (const std::string& name : c.options.scenes)
    if (!bench::exact_scene(name)) require_scenes({name});
  prepare_report(c.report, kName);
  if (!c.report.empty()) make_folder(std::filesystem::path(c.report) / kName);
  if (c.options.povray && !bench::has_povray()) say("povray is not installed: its points are left out");
  const bench::AccuracyCalls calls = {
      .done =
          [&](std::span<const bench::AccuracyRun> runs) {
            print_table(bench::table_of(runs.back()));
            write_report(c.report, kName, bench::json_of(runs, c.options));
          },
      .working = say_working,
      .picture =
          [&](const std::string& scene, const std::string& name, const image::Image& image) {
            if (c.report.empty()) return;
            const auto folder = std::filesystem::path(c.report) / kName;
            image::write_picture(folder / bench::picture_name(scene, name), image, {}, {});
          }};
  const auto runs = bench::bench_accuracy(c.options, calls);
  require_none(bench::count_unlike_base(runs), "traversals or trees don't give the base's picture");
  return 0;
}

int parse_samples(const std::string& text) {
  const int samples = parse_int("--reference-samples", text, bench::kReferenceStep, kSamplesMax);
  if (samples % bench::kReferenceStep != 0)
    throw usage_error("--reference-samples", text, fmt::format("a multiple of {}", bench::kReferenceStep));
  return samples;
}

void add_options(CLI::App& app, AccuracyCommand& c) {
  bench::AccuracyOptions& o = c.options;
  add_scenes(app, o.scenes);
  add_size(app, "Pixels across and down (default 512x512)", kReferenceSideMax, kReferencePixelsMax, o.width,
           o.height);
  add_text(app, "--reference-samples", "N",
           "Samples per pixel of the reference, a multiple of 32 (default 256)",
           [&o](const std::string& text) { o.reference_samples = parse_samples(text); });
  app.add_flag_callback(
      "--no-povray", [&o] { o.povray = false; }, "Leave POV-Ray out");
  app.add_flag("--quick", o.quick, "A few settings only");
}

}  // namespace

Command add_bench_accuracy(CLI::App& bench) {
  return add_command(
      bench, kName,
      "Time against error: samples, depth, least weight and the rest, and POV-Ray's antialiasing",
      add_options, run);
}

}  // namespace kdray::cli
