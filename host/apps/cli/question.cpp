#include "apps/cli/question.h"

#include <fmt/format.h>

#include <utility>

#include "apps/cli/memory.h"
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
  add_path(app, "--rays",
           "The rays, a NumPy array or a text: N x 8: origin, t_min, direction, t_max; or N x 6", args.rays);
  app.add_flag("--any-hit", args.any_hit, "Only whether something is hit, not what is hit first")
      ->group(group);
  app.add_flag("--all-hits", args.all_hits, "All that each ray crosses, to an .npz")->group(group);
  add_int(app, "--max-hits", "With --all-hits: the first N of each ray", 1, 2147483647, args.max_hits)
      ->group(group);
  app.add_flag("--count", args.count, "How many surfaces each ray crosses")->group(group);
  const std::string points = " of these points, a NumPy array or a text: N x 3";
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
  const std::string ending = ending_of(output);
  const bool npz = ending == ".npz";
  if (!npz && !ending.empty() && ending != ".npy" && ending != ".csv")
    refuse(fmt::format("--output '{}': expected a name that ends in .npy, .npz or .csv", output));
  if (question != Question::all && ending == ".csv") return array::TableFormat::csv;
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

namespace {

// Of the answer to one ray or point; of all hits for two of them, and what room for more is held meanwhile.
std::uint64_t answer_bytes(Question question) {
  switch (question) {
    case Question::closest:
      return 20;
    case Question::any:
      return 21;
    case Question::all:
      return 160;
    case Question::count:
      return 4;
    case Question::closest_point:
      return 56;
    case Question::signed_distance:
      return 8;
    case Question::inside:
      return 1;
  }
  return 0;
}

}  // namespace

RequestedRows::RequestedRows(array::RowsFile& file, const TraceRequest& request, std::uint64_t free) {
  const bool of_points = is_of_points(request.question);
  const bool traced = !of_points && !file.in_double() && request.question <= Question::any;
  if (traced)
    check_rays_fit(file.size(), free);
  else
    check_rows_fit(request.wanted().name, file.size(), file.row_bytes() + answer_bytes(request.question),
                   free);
  if (of_points && file.in_double())
    rows_ = file.read<std::array<double, 3>>();
  else if (of_points)
    rows_ = file.read<std::array<float, 3>>();
  else if (file.in_double())
    rows_ = file.read<std::array<double, 8>>();
  else
    rows_ = file.read<Ray>();
}

std::size_t RequestedRows::size() const {
  return std::visit([](const auto& rows) { return rows.size(); }, rows_);
}

Rays RequestedRows::rays(std::size_t n) const {
  if (n == 0) return {};
  if (const auto* const floats = std::get_if<std::vector<Ray>>(&rows_))
    return Rays::of(std::span(*floats).first(n));
  const auto& rows = std::get<Rows<double, 8>>(rows_);
  const std::span<const double> values(rows.front().data(), 8 * rows.size());
  constexpr std::size_t kStride = 8 * sizeof(double);
  return {{values, n, kStride},
          {values.subspan(4), n, kStride},
          {values.subspan(3), n, kStride},
          {values.subspan(7), n, kStride},
          {}};
}

Points RequestedRows::points(std::size_t n) const {
  if (n == 0) return {};
  if (const auto* const floats = std::get_if<Rows<float, 3>>(&rows_)) return {floats->front().data(), n};
  return {std::get<Rows<double, 3>>(rows_).front().data(), n};
}

}  // namespace kdray::cli
