// What    What kdray trace asks of a scene: which question the options name, of which file's rays or points,
//         and in which form the answers are written.
// Errors  kdray::Error, ErrorCode::usage: options that contradict each other.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "io/array/rows_file.h"
#include "io/array/table.h"
#include "kdray/options.h"

namespace kdray::cli {

enum class Question { closest, any, all, count, closest_point, signed_distance, inside };

inline bool is_of_points(Question question) {
  return question >= Question::closest_point;
}

// "closest_point", for statistics.
const char* name_of(Question question);

// What the options said.
struct QuestionArgs {
  std::string rays, closest_point, signed_distance, inside;  // files
  bool any_hit = false, all_hits = false, count = false;
  int max_hits = 0;  // 0: not given
};
void add_question_options(CLI::App& app, QuestionArgs& args);

struct TraceRequest {
  Question question;
  std::string option, file;  // "--rays" and the file that it names

  const array::RowsWanted& wanted() const { return is_of_points(question) ? array::kPoints : array::kRays; }
};
TraceRequest request_of(const QuestionArgs& args);

// By the ending of the file's name; to stdout ("-") an .npy where it holds the answers.
array::TableFormat format_of(const std::string& output, Question question);

// Whether a Renderer traces the rays, which have been on the device before the time counts: the closest or
// any hits of float rays. Throws where it is not, and options ask for what a Renderer alone has.
bool is_for_renderer(const TraceRequest& request, bool in_double, Traversal traversal, Precision precision);

}  // namespace kdray::cli
