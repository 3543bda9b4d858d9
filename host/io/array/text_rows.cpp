#include "io/array/text_rows.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

#include "base/error.h"

namespace kdray::array {

namespace {

constexpr std::string_view kBetween = " \t,;\r";

// Takes the next word off the front; empty at the end.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBetween));
  line.remove_prefix(word.size());
  return word;
}

// Of a number beyond a double's range, whether it is one.
bool read_value(std::string_view word, double& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && end == word.data() + word.size() && error == std::errc();
}

class TextReader {
 public:
  TextReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  TextRows read() {
    while (!text_.empty()) {
      ++line_;
      const std::size_t end = text_.find('\n');
      read_line(text_.substr(0, end));
      text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
    }
    return std::move(rows_);
  }

 private:
  void read_line(std::string_view line) {
    std::string_view word = take_word(line);
    if (word.empty() || word.starts_with('#')) return;
    const bool is_first = !std::exchange(begun_, true);
    std::size_t n = 0;
    for (; !word.empty(); word = take_word(line), ++n) {
      double value = 0;
      if (read_value(word, value)) {
        rows_.values.push_back(value);
      } else if (is_first && n == 0) {
        return;  // a header
      } else {
        throw input_error(file_, line_, "'" + std::string(word.substr(0, 40)) + "' is no number");
      }
    }
    if (rows_.n_columns == 0) rows_.n_columns = n;
    if (n != rows_.n_columns)
      throw input_error(file_, line_,
                        "has " + std::to_string(n) + " numbers, and the lines before it " +
                            std::to_string(rows_.n_columns));
  }

  std::string_view text_;
  const std::string& file_;
  std::uint32_t line_ = 0;
  bool begun_ = false;
  TextRows rows_;
};

}  // namespace

bool looks_like_text(std::string_view start) {
  return std::ranges::all_of(
      start, [](unsigned char c) { return c >= ' ' ? c < 127 : c == '\n' || c == '\t' || c == '\r'; });
}

TextRows read_text_rows(std::string_view text, const std::string& file) {
  return TextReader(text, file).read();
}

}  // namespace kdray::array
