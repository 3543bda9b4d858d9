// What    kdray trace: rays or points from a file or a pipe, what a scene answers to a file.
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/answers.h"
#include "apps/cli/command.h"
#include "apps/cli/open_scene.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/question.h"
#include "apps/cli/run_files.h"
#include "apps/cli/scene_input.h"
#include "apps/cli/stats.h"
#include "apps/cli/summary.h"
#include "base/error.h"
#include "base/process_memory.h"
#include "base/timer.h"
#include "io/array/table.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::cli {

namespace {

struct TraceArgs {
  SceneInput scene;
  QuestionArgs question;
  std::string output, stats;
  bool quiet = false, verbose = false;
  int repeat = 1;
  Traversal traversal = Traversal::automatic;
  Precision precision = Precision::float32;
  CacheChoice cache;
  TreeOptions tree;
  DeviceOptions device;
};

// What came of it.
struct Traced {
  Statistics figures;
  std::uint64_t n_found = 0;
};

void check_files(const TraceArgs& o, const TraceRequest& request, RunFiles& files) {
  check_scene_input(o.scene);
  files.read("SCENE", o.scene.file);
  files.read(request.option, request.file);
  if (o.output == "-") check_stdout_takes_bytes("--output");
  files.write("--output", o.output);
  files.write("--stats", o.stats);
}

void write_answers(const std::string& output, std::span<const array::Column> columns,
                   array::TableFormat format, Statistics& figures) {
  const Timer timer;
  output == "-" ? array::write_table(columns, format, print) : array::write_table(output, columns, format);
  figures.seconds.write = timer.seconds();
}

// The API doesn't know where the rays and points come from, and nobody knows beforehand how many hits they
// have.
template <class Work>
auto naming_file(const std::string& file, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    throw input_error(file, 0, error.what());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory,
                file +
                    ": out of memory for the answers; ask about fewer rays or points at a time, or for "
                    "--max-hits of them");
  }
}

Traced trace(const OpenedScene& scene, const TraceArgs& o, const TraceRequest& request,
             const RequestedRows& rows) {
  Renderer renderer(scene.scene(), scene.device());
  std::vector<std::uint32_t> instances;
  const std::vector<Hit> hits = naming_file(request.file, [&] {
    return renderer.trace(rows.structs(), request.question == Question::any, o.repeat, o.traversal,
                          o.precision, &instances);
  });
  const auto found = std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return std::isfinite(h.t); });
  Traced traced{renderer.statistics(), static_cast<std::uint64_t>(found)};
  write_answers(o.output, columns_of(hits, instances), format_of(o.output, request.question), traced.figures);
  return traced;
}

// Rows that are asked about for nothing where kernels were compiled: PoCL compiles them once more at their
// first launch, for few work-items and for many.
constexpr std::size_t kWarmUp = std::size_t{1} << 17;

// All else. Before the time counts the first row is asked about alone.
Traced ask(const OpenedScene& scene, const TraceArgs& o, const TraceRequest& request,
           const RequestedRows& rows) {
  api::Committed committed(scene.scene(), scene.device(), {o.traversal, o.precision});
  const query::QueryContext of = committed.query_context();
  const int max_hits = o.question.max_hits;
  Answers answers(request.question, max_hits > 0 ? static_cast<std::uint32_t>(max_hits) : 0xffffffffu);
  std::vector<double> seconds(static_cast<std::size_t>(o.repeat));
  Timer timer;
  const double prepare = naming_file(request.file, [&] {
    answers.ask(of, rows, std::min<std::size_t>(rows.size(), 1));
    if (committed.has_compiled()) answers.ask(of, rows, std::min(rows.size(), kWarmUp));
    const double first = timer.seconds();
    for (double& s : seconds) {
      timer.restart();
      answers.ask(of, rows, rows.size());
      s = timer.seconds();
    }
    return std::max(0.0, first - committed.build_seconds());
  });
  Traced traced{committed.statistics(rows.size(), seconds), answers.n_found()};
  traced.figures.seconds.prepare = prepare;
  write_answers(o.output, answers.columns(), format_of(o.output, request.question), traced.figures);
  return traced;
}

Json answers_told(const TraceArgs& o, const TraceRequest& request, std::size_t n_rows,
                  std::uint64_t n_found) {
  return {{"file", o.output}, {"asked", name_of(request.question)},           {request.wanted().name, n_rows},
          {"hits", n_found},  {"any_hit", request.question == Question::any}, {"repeat", o.repeat}};
}

int run(const TraceArgs& o) {
  const Timer total;
  const TraceRequest request = request_of(o.question);
  check_walk(request.question, o.traversal, o.precision, o.tree.geometry);
  RunFiles files;
  check_files(o, request, files);
  static_cast<void>(format_of(o.output, request.question));
  const Timer step;
  array::RowsFile file(request.file, request.wanted());
  // Closest and any hits of floats, which are on the devices before the time counts.
  const bool by_renderer =
      is_plain(request.question) && !file.in_double() && o.tree.geometry == VertexPrecision::float32;
  const RequestedRows rows(file, request, free_memory());
  const double read_rays = step.seconds();

  TreeOptions tree = o.tree;
  tree.binary_form = takes_binary_form(o.traversal, o.precision);
  OpenedScene scene(o.scene, tree, o.device, o.cache, o.quiet,
                    [&files](const scene::Scene& read) { files.read_scene(read.files); });
  auto [figures, n_found] = (by_renderer ? trace : ask)(scene, o, request, rows);
  scene.keep();
  scene.add_to(figures.seconds);
  figures.seconds.read_rays = read_rays;
  figures.seconds.total = total.seconds();

  Json stats = collect_stats("trace", o.scene.file, figures);
  stats["cache"] = scene.cache();
  stats["hits"] = answers_told(o, request, rows.size(), n_found);
  if (!o.stats.empty()) write_stats(o.stats, stats);
  if (!o.quiet) print_trace_summary(stats, o.verbose);
  return 0;
}

}  // namespace

Command add_trace(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("trace", "Trace rays from a file and write their hits");
  const auto o = std::make_shared<TraceArgs>();
  add_scene_input(*app, o->scene, "The scene, as for render");
  add_question_options(*app, o->question);
  add_path(*app, "-o,--output",
           "The answers: .npy, .npz with an array for each field, or .csv; '-': .npy to standard output",
           o->output)
      ->required();
  add_int(*app, "--repeat", "Ask that often and report the median time (default 1)", 1, 1000000, o->repeat);
  add_path(*app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o->stats);
  add_loudness(*app, o->quiet, o->verbose);
  add_device_options(*app, o->device, o->traversal, o->precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  add_geometry_option(*app, o->tree.geometry);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
