// What    Someone who answers questions about a mesh: kdray, or Embree in one of its forms. From arrays to
//         arrays: what handing rays over and taking answers back costs is theirs.
// Shape   ask() answers rays or points [first, first + n) of a set, in the same places of Answers; the
//         crossings of `all` in place of those of the call before.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/workload/arrays.h"

namespace kdray::bench {

enum class Question { closest, any, count, all, points, distance, inside };

// In the order of Question.
inline std::span<const std::string_view> question_names() {
  static constexpr std::string_view kNames[] = {"closest", "any",      "count", "all",
                                                "points",  "distance", "inside"};
  return kNames;
}
inline Question question_of(std::string_view name) {
  return static_cast<Question>(std::ranges::find(question_names(), name) - question_names().begin());
}

struct Answers {
  // Of `closest`; of `points` the distance is `t`.
  std::vector<float> t, u, v;
  std::vector<double> double_t;  // in place of t, from a side that answers in doubles
  bool in_double = false;
  std::vector<std::uint32_t> geometry, primitive;
  std::vector<float> point;       // of `points`
  std::vector<std::uint8_t> hit;  // of `any`, `inside`
  std::vector<std::uint32_t> count;
  AllHits all;

  // Capacity for what a question about n rays or points is answered by.
  Answers(Question question, std::size_t n) {
    const bool is_place = question == Question::closest || question == Question::points;
    if (is_place || question == Question::distance) t.resize(n), double_t.resize(n);
    if (is_place) u.resize(n), v.resize(n), geometry.resize(n), primitive.resize(n);
    if (question == Question::points) point.resize(3 * n);
    if (question == Question::any || question == Question::inside) hit.resize(n);
    if (question == Question::count) count.resize(n);
  }

  double t_of(std::size_t i) const { return in_double ? double_t[i] : double{t[i]}; }
};

class Asker {
 public:
  virtual ~Asker() = default;
  virtual void ask(Question question, const QuerySet& set, std::size_t first, std::size_t n,
                   Answers& answers) = 0;
};

// A side of the race, with the forms that it has; the best of them counts.
struct Side {
  std::string name;  // "kdray", "fast", "robust"
  struct Form {
    std::string name;  // "1 coherent"
    std::shared_ptr<Asker> asker;
  };
  std::vector<Form> forms;
  // Makes all of it anew from the arrays, asks one ray, and forgets it.
  std::function<void(const QuerySet& set)> first_answer;
};

}  // namespace kdray::bench
