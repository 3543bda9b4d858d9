#include "bench/race/asker.h"

#include <algorithm>
#include <array>

#include "base/error.h"

namespace kdray::bench {

namespace {

constexpr std::array<std::string_view, 7> kQuestionNames = {"closest", "any",      "count", "all",
                                                            "points",  "distance", "inside"};

}  // namespace

std::span<const std::string_view> question_names() {
  return kQuestionNames;
}

Question question_of(std::string_view name) {
  const auto found = std::find(kQuestionNames.begin(), kQuestionNames.end(), name);
  if (found == kQuestionNames.end())
    throw Error(ErrorCode::usage, "there is no question '" + std::string(name) + "'");
  return static_cast<Question>(found - kQuestionNames.begin());
}

Answers::Answers(Question question, std::size_t n) {
  const bool is_place = question == Question::closest || question == Question::points;
  if (is_place || question == Question::distance) t.resize(n);
  if (is_place) u.resize(n), v.resize(n), geometry.resize(n), primitive.resize(n);
  if (question == Question::points) point.resize(3 * n);
  if (question == Question::any || question == Question::inside) hit.resize(n);
  if (question == Question::count) count.resize(n);
}

}  // namespace kdray::bench
