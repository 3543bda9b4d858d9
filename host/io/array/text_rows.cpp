#include "io/array/text_rows.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <utility>

#include "base/error.h"

namespace kdray::array {

namespace {

constexpr std::string_view kBlank = " \t\r", kMark = "\xef\xbb\xbf";

bool read_value(std::string_view word, double& value) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return !word.empty() && end == word.data() + word.size() && error == std::errc();
}

// The words of a line: what stands between blanks, or between commas or semicolons with blanks around them or
// none.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) { skip_blanks(); }

  bool at_end() const { return rest_.empty() && !comma_; }
  // Empty where nothing stands before a comma, or behind the last one.
  std::string_view next() {
    comma_ = false;
    const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r,;"));
    rest_.remove_prefix(word.size());
    skip_blanks();
    if (rest_.starts_with(',') || rest_.starts_with(';')) {
      comma_ = true;
      rest_.remove_prefix(1);
      skip_blanks();
    }
    return word;
  }

 private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlank), rest_.size())); }

  std::string_view rest_;
  bool comma_ = false;  // one more word follows, if an empty one
};

// Names, and nothing that might be meant for a number.
bool is_header(std::string_view line) {
  for (Words words(line); !words.at_end();) {
    const std::string_view word = words.next();
    double value = 0;
    if (word.empty() || read_value(word, value) || word.find_first_of("+-.0123456789") == 0) return false;
  }
  return true;
}

std::string shown(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

class TextReader {
 public:
  TextReader(std::string_view text, const std::string& file) : text_(text), file_(file) {
    if (text_.starts_with(kMark)) text_.remove_prefix(kMark.size());
  }

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
    line = line.substr(0, line.find('#'));
    Words words(line);
    if (words.at_end()) return;
    if (!std::exchange(begun_, true) && is_header(line)) return;
    std::size_t n = 0;
    for (; !words.at_end(); ++n) {
      const std::string_view word = words.next();
      double value = 0;
      if (!read_value(word, value))
        throw input_error(file_, line_,
                          word.empty() ? "nothing stands between two commas, or behind the last one"
                                       : "'" + shown(word) + "' is no number that a double holds");
      rows_.values.push_back(value);
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
  constexpr unsigned char kDelete = 127;
  return !start.starts_with("\x93NUMPY") && std::ranges::all_of(start, [](unsigned char c) {
    return c >= ' ' ? c != kDelete : c == '\n' || c == '\t' || c == '\r';
  });
}

TextRows read_text_rows(std::string_view text, const std::string& file) {
  return TextReader(text, file).read();
}

}  // namespace kdray::array
