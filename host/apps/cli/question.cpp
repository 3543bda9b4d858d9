#include "apps/cli/question.h"

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

#include "apps/cli/options.h"
#include "apps/cli/output.h"

namespace kdray::cli {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, what);
}

// What was asked, each with its option and, of points, the file.
std::vector<TraceRequest> all_requests(const QuestionArgs& args) {
  std::vector<TraceRequest> requests;
  const auto of_rays = [&](bool given, Question question, const char* option) {
    if (given) requests.push_back({question, option, args.rays});
  };
  const auto of_points = [&](const std::string& file, Question question, const char* option) {
    if (!file.empty()) requests.push_back({question, option, file});
  };
  of_rays(args.any_hit, Question::any, "--any-hit");
  of_rays(args.all_hits, Question::all, "--all-hits");
  of_rays(args.count, Question::count, "--count");
  of_points(args.closest_point, Question::closest_point, "--closest-point");
  of_points(args.signed_distance, Question::signed_distance, "--signed-distance");
  of_points(args.inside, Question::inside, "--inside");
  return requests;
}

}  // namespace

const char* name_of(Question question) {
  constexpr std::array kNames = {"closest",         "any",   "all", "count", "closest_point",
                                 "signed_distance", "inside"};
  return kNames[static_cast<std::size_t>(question)];
}

void add_question_options(CLI::App& app, QuestionArgs& args) {
  const std::string group = "What is asked (without: the closest hits of --rays)";
  add_path(app, "--rays", "The rays: float32 or float64, N x 8: origin, t_min, direction, t_max", args.rays);
  app.add_flag("--any-hit", args.any_hit, "Only whether something is hit, not what is hit first")
      ->group(group);
  app.add_flag("--all-hits", args.all_hits, "All that each ray crosses, to an .npz")->group(group);
  add_int(app, "--max-hits", "With --all-hits: the first N of each ray", 1, 2147483647, args.max_hits)
      ->group(group);
  app.add_flag("--count", args.count, "How many surfaces each ray crosses")->group(group);
  const std::string points = " of these points: float32 or float64, N x 3";
  add_path(app, "--closest-point", "What lies nearest to each" + points, args.closest_point)->group(group);
  add_path(app, "--signed-distance", "How far the nearest surface is, negative inside," + points,
           args.signed_distance)
      ->group(group);
  add_path(app, "--inside", "Whether each lies in closed surfaces," + points, args.inside)->group(group);
}

TraceRequest request_of(const QuestionArgs& args) {
  const std::vector<TraceRequest> requests = all_requests(args);
  if (requests.size() > 1)
    refuse(fmt::format("{} and {} ask different things; give one of them", requests[0].option,
                       requests[1].option));
  if (args.max_hits > 0 && !args.all_hits) refuse("--max-hits is for --all-hits alone");
  const Question question = requests.empty() ? Question::closest : requests[0].question;
  if (is_of_points(question)) {
    if (!args.rays.empty()) refuse(fmt::format("{} asks about points; leave --rays out", requests[0].option));
    return requests[0];
  }
  if (args.rays.empty())
    refuse("--rays is required, or a question about points: --closest-point, --signed-distance, --inside");
  return {question, "--rays", args.rays};
}

array::TableFormat format_of(const std::string& output, Question question) {
  const bool npz = ending_of(output) == ".npz";
  if (question != Question::all) return npz ? array::TableFormat::npz : array::TableFormat::npy;
  if (!npz && output != "-")
    refuse(fmt::format(
        "--output '{}': expected a name that ends in .npz, since --all-hits has arrays of several lengths",
        output));
  return array::TableFormat::npz;
}

void check_walk(Question question, Traversal traversal, Precision precision, VertexPrecision geometry) {
  const bool is_closest_point = question == Question::closest_point;
  if (traversal != Traversal::automatic && is_closest_point)
    refuse("--traversal is how rays walk the tree, and --closest-point has a walk of its own; leave it out");
  if (traversal == Traversal::binary && !is_plain(question))
    refuse(
        fmt::format("the binary walk finds closest and any hits alone, and {} needs all; take another "
                    "--traversal",
                    name_of(question)));
  if (precision == Precision::float64 && !is_plain(question))
    refuse(
        fmt::format("--precision double is for closest and any hits; {} decides in double by itself what "
                    "float leaves open; leave it out",
                    name_of(question)));
  if (geometry != VertexPrecision::float32 &&
      (traversal != Traversal::automatic || precision == Precision::float64))
    refuse(
        "--geometry double (or auto) is answered by exact arithmetic and has a walk of its own; leave "
        "--traversal and --precision out");
}

}  // namespace kdray::cli
