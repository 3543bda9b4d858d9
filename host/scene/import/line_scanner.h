// What    Reads text in which a line is a statement (OBJ, MTL): a keyword, words and numbers, or a rest of
//         line.
// Shape   A backslash at the end of a line, blanks after it or not, joins the next one to it. '#' at the
//         start of a word ends the line's words, but not its rest(): names may hold one. Lines end in \n,
//         \r\n or \r; the first is line 1. A UTF-8 byte order mark is skipped.
// Errors  "file:line: expected WHAT, found 'WORD'". UTF-16 is refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene {

class LineScanner {
 public:
  // `text` must outlive the scanner; `file` is the name in messages.
  LineScanner(std::string_view text, std::string file);

  // Goes to the next line, whatever is left of this one; false at the end of the text.
  bool next_line();
  // The next word of the line; empty at its end.
  std::string_view word();
  // The next word if it is digits only, and its value; empty, with nothing taken, if it is anything else.
  std::string_view plain_whole(std::int64_t& value);
  // What is left of the line, without white space at its ends; valid until the next rest().
  std::string_view rest();
  // The next word as a number; `what` says what the number is.
  double number(std::string_view what, NotFinite other = NotFinite::refused);
  // The same as number(), but returns false, with nothing taken, when the line has no more words.
  bool try_number(std::string_view what, double& value, NotFinite other = NotFinite::refused);

  std::uint32_t line() const { return line_; }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::string& file() const { return file_; }
  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const;

 private:
  void skip_space();
  const char* end_of_join(const char* p) const;
  bool ends_word(const char* p) const;

  const char* at_;
  const char* end_;
  std::uint32_t line_ = 0;  // of the word taken last
  bool started_ = false;
  std::string joined_;  // a rest() of several lines
  std::string file_;
};

}  // namespace kdray::scene
