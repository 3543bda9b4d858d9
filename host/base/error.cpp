#include "base/error.h"

#include <algorithm>
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

// Levenshtein's edit distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, change}));
    }
  }
  return row.back();
}

}  // namespace

std::string_view nearest_name(std::string_view word, std::span<const std::string_view> names) {
  if (word.size() > 64) return "";
  std::string_view best;
  std::size_t least = 1 + (word.size() < 3 ? 1 : std::max<std::size_t>(word.size() / 2, 2));
  for (const std::string_view name : names) {
    const std::size_t d = edit_distance(word, name);
    if (d < least) least = d, best = name;
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> names) {
  const std::string_view best = nearest_name(word, names);
  return best.empty() ? "" : "did you mean '" + std::string(best) + "'?";
}

}  // namespace kdray
