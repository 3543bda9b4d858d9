// What    Reads words and numbers from the text of a scene file, and knows the line it is at.
// Shape   Tokens are separated by white space (new lines included); '#' starts a comment to the end of its
//         line. Lines end in \n, \r\n or \r; the first is line 1.
// Errors  Everything that is not a finite number where one is wanted is refused: "file:line: expected WHAT,
//         found 'TOKEN'". A number too small for a double is 0. Where NotFinite says so, what stands for a
//         number that is not finite is NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/vec.h"

namespace kdray::scene {

// What becomes of a number that is not finite ("nan", "-inf", "1.#IND", "1e999"): it is refused, or NaN.
enum class NotFinite { refused, nan };

class TextScanner {
 public:
  // `text` must outlive the scanner; `file` is the name in messages.
  TextScanner(std::string_view text, std::string file);

  // True when nothing but white space and comments is left; otherwise stands at the next token.
  bool at_end();
  // The next token without taking it; empty at the end. Views stay valid as long as the text.
  std::string_view peek();
  // Takes the next token; `what` is what the error says was expected when there is none.
  std::string_view word(std::string_view what);
  // Whether the next token starts like a number (a digit, a sign or a point).
  bool at_number();

  double number(std::string_view what, NotFinite other = NotFinite::refused);
  dvec3 vector(std::string_view what, NotFinite other = NotFinite::refused);  // three numbers
  std::uint32_t count(std::string_view what);                                 // a whole number, 0 to 2^32 - 1
  std::uint32_t line() const { return line_; }  // of the token last taken or peeked
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::string& file() const { return file_; }

  // An error at line(). `expected` makes the message for the token that stands next.
  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const;
  [[nodiscard]] Error expected(std::string_view what);

 private:
  void skip_space();
  const char* token_end() const;
  bool ends_token(const char* p) const;

  const char* at_;
  const char* end_;
  std::uint32_t line_ = 1;
  std::uint32_t last_line_ = 1;  // of the last token taken: where the text ends, for a person
  std::string file_;
};

// Whether all of [first, last) is one finite number, correctly rounded into `value`.
bool read_number(const char* first, const char* last, double& value);

// The same, but true with NaN where the word stands for a number that is not finite.
bool read_number_or_nan(const char* first, const char* last, double& value);

// A token as it may be shown in a message: control characters as '?', at most 40 characters.
std::string printable(std::string_view token);

}  // namespace kdray::scene
