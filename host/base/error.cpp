#include "base/error.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace kdray {

Error input_error(const std::string& file, std::size_t line, const std::string& what,
                  const std::string& remedy) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  text += ": " + what;
  if (!remedy.empty()) text += "; " + remedy;
  // Names and what a file says may hold anything.
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return Error(ErrorCode::input, text);
}

namespace {

// Damerau and Levenshtein's distance, where no part is edited twice: insertions, deletions, changes, and two
// neighbours that have changed places.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
    std::swap(before, row), std::swap(row, next);
  }
  return row.back();
}

// The beginning of a name, of three letters or more, is as good as a slip.
std::size_t distance_to(std::string_view word, std::string_view name) {
  return word.size() >= 3 && name.starts_with(word) ? 1 : edit_distance(word, name);
}

}  // namespace

// One slip in three letters at most, so that what is suggested is what was meant; of equals the shortest.
std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names) {
  constexpr std::size_t kLongest = 64, kLettersPerSlip = 3;
  if (word.size() > kLongest) return "";
  std::string_view best;
  std::size_t least = kLongest;
  for (const std::string_view name : names) {
    const std::size_t d = distance_to(word, name);
    if (d > std::max(word.size(), name.size()) / kLettersPerSlip) continue;
    if (d < least || (d == least && name.size() < best.size())) least = d, best = name;
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> names) {
  const std::string_view best = nearest_name(word, names);
  return best.empty() ? "" : "did you mean '" + std::string(best) + "'?";
}

}  // namespace kdray
