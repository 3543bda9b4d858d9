// What    What kdray trace asks of a scene: which question the options name, of which file's rays or points,
//         and in which form the answers are written.
// Errors  kdray::Error, ErrorCode::usage: options that contradict each other.
#pragma once

#include <CLI/CLI.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "io/array/rows_file.h"
#include "io/array/table.h"
#include "kdray/options.h"
#include "kdray/query.h"

namespace kdray::cli {

enum class Question { closest, any, all, count, closest_point, signed_distance, inside };

inline bool is_of_points(Question question) {
  return question >= Question::closest_point;
}

// Whether one hit of each ray is asked for, which all walks find.
inline bool is_plain(Question question) {
  return question == Question::closest || question == Question::any;
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

// By the ending of the file's name; for stdout ("-") .npy, or .npz where .npy can't hold the answers.
array::TableFormat format_of(const std::string& output, Question question);

// Throws for a walk, or a precision of kernels or geometry, in which there is no answer to that question.
void check_walk(Question question, Traversal traversal, Precision precision, VertexPrecision geometry);

// The rays or points that kdray trace asks about, as their file has them: float or double. Views of them,
// as the API takes them (kdray/query.h). Errors: kdray::Error: the file's own (io/array/rows_file.h);
// ErrorCode::out_of_memory where they and their answers don't fit.
class RequestedRows {
 public:
  // Reads all of the file. `free`: bytes of memory.
  RequestedRows(array::RowsFile& file, const TraceRequest& request, std::uint64_t free);

  std::size_t size() const;
  // Views of the first n.
  Rays rays(std::size_t n) const;
  Points points(std::size_t n) const;
  // All of them, where they are rays of floats.
  std::span<const Ray> structs() const { return std::get<std::vector<Ray>>(rows_); }

 private:
  template <class T, std::size_t N>
  using Rows = std::vector<std::array<T, N>>;
  std::variant<std::vector<Ray>, Rows<double, 8>, Rows<float, 3>, Rows<double, 3>> rows_;
};

}  // namespace kdray::cli
