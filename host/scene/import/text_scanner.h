// What    What the readers of text formats share: scanners for words and numbers that know the line they are
//         at, a count of what is left out, and capacity for what is still to come.
// Shape   Lines end in \n, \r\n or \r; the first is line 1.
// Errors  Everything that is not a finite number where one is wanted is refused: "file:line: expected WHAT,
//         found 'TOKEN'".
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "base/vec.h"

namespace kdray::scene {

// Reads the numbers that files are full of, such as -0.0125 or 871414, in one pass and without a call;
// whatever is longer, larger or odd is left to std::from_chars. Each function returns where the number
// ends, or nullptr for "not a plain one: ask from_chars"; the value is then untouched. The caller looks at
// what follows the number. Why: A scanner that first looks for a token's end and then parses it sees each
// digit twice, and pays two calls. Source: W. D. Clinger, "How to read floating point numbers accurately",
// 1990: digits below 2^53 and a power of ten up to 10^22 are doubles both, so that one division or product
// of them is the correctly rounded value.

// Reads the digits at `p`, behind those in `value` already. They wrap around when there are more than 19.
inline const char* take_digits(const char* p, const char* end, std::uint64_t& value) {
  for (; p != end; ++p) {
    const auto digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0';
    if (digit > 9) break;
    value = value * 10 + digit;
  }
  return p;
}

// Reads a whole number without a sign.
inline const char* read_plain_whole(const char* p, const char* end, std::int64_t& value) {
  constexpr std::ptrdiff_t kMostDigits = 18;  // below 2^63
  std::uint64_t digits = 0;
  const char* const stop = take_digits(p, end, digits);
  if (stop == p || stop - p > kMostDigits) return nullptr;
  value = static_cast<std::int64_t>(digits);
  return stop;
}

// Reads a decimal number without an exponent.
inline const char* read_plain_number(const char* p, const char* end, double& value) {
  constexpr std::array<double, 23> kPowers = {1,    1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::ptrdiff_t kMostDigits = 19;  // below 2^64
  const bool negative = p != end && *p == '-';
  if (negative) ++p;
  std::uint64_t digits = 0;
  const char* const first = p;
  p = take_digits(p, end, digits);
  std::ptrdiff_t count = p - first;
  std::ptrdiff_t places = 0;
  if (p != end && *p == '.') {
    const char* const point = p;
    p = take_digits(p + 1, end, digits);
    places = p - point - 1;
    if (places == 0) return nullptr;
    count += places;
  }
  const bool exponent = p != end && (*p == 'e' || *p == 'E');
  if (count == 0 || count > kMostDigits || digits > std::uint64_t{1} << 53 || exponent) return nullptr;
  const double magnitude = static_cast<double>(digits) / kPowers[static_cast<std::size_t>(places)];
  value = negative ? -magnitude : magnitude;
  return p;
}

// ---- TextScanner: tokens are separated by white space (new lines included); '#' starts a comment to the end
// of its line. A number too small for a double is 0. With NotFinite::nan a word for a number that is not
// finite is NaN.

// Whether a number that is not finite ("nan", "-inf", "1.#IND", "1e999") is refused, or read as NaN.
enum class NotFinite { refused, nan };

class TextScanner {
 public:
  // `text` must outlive the scanner; `file` is the name in messages.
  TextScanner(std::string_view text, std::string file);

  // Returns true when nothing but white space and comments is left; otherwise it then stands at the next
  // token.
  bool at_end();
  // Returns the next token without taking it; empty at the end. Views stay valid as long as the text.
  std::string_view peek();
  // Takes the next token; when there is none, the error says that `what` was expected.
  std::string_view word(std::string_view what);
  // Returns whether the next token starts like a number (a digit, a sign or a point).
  bool at_number();

  double number(std::string_view what, NotFinite other = NotFinite::refused);
  dvec3 vector(std::string_view what, NotFinite other = NotFinite::refused);  // three numbers
  std::uint32_t count(std::string_view what);                                 // a whole number, 0 to 2^32 - 1
  std::uint32_t line() const { return line_; }  // of the token last taken or peeked
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  const std::string& file() const { return file_; }

  // Returns an error at line(); expected() makes the message for the token that stands next.
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

// Returns whether all of [first, last) is one finite number, correctly rounded into `value`.
bool read_number(const char* first, const char* last, double& value);

// Does the same, but also returns true, with NaN, where the word stands for a number that is not finite.
bool read_number_or_nan(const char* first, const char* last, double& value);

// Returns a token as it may be shown to a person: '?' for what is no UTF-8 and for characters that change how
// a line is shown (controls, directions of writing, ends of lines), at most `longest` bytes.
std::string printable(std::string_view token, std::size_t longest = 40);

// ---- LineScanner: a line is a statement (OBJ, MTL): a keyword, words and numbers, or a rest of line. A
// backslash at the end of a line, blanks after it or not, joins the next one to it. '#' at the start of a
// word ends the line's words, but not its rest(): names may hold one. A UTF-8 byte order mark is skipped,
// UTF-16 is refused.

class LineScanner {
 public:
  // `text` must outlive the scanner; `file` is the name in messages.
  LineScanner(std::string_view text, std::string file);

  // Goes to the next line, whatever is left of this one; returns false at the end of the text.
  bool next_line();
  // Returns the next word of the line; empty at its end.
  std::string_view word();
  // Returns the next word if it is digits only, and its value; empty, with nothing taken, if it is anything
  // else.
  std::string_view plain_whole(std::int64_t& value);
  // Returns what is left of the line, without white space at its ends; valid until the next rest().
  std::string_view rest();
  // Returns the next word as a number; `what` says what the number is.
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

// Counts what the reader of a text format leaves out: one warning of each kind, with the line of the first
// and how many there were.
class LeftOut {
 public:
  // `what` follows the number: "faces with fewer than 3 corners are left out".
  void add(std::string_view what, std::uint32_t line) {
    auto kind = std::ranges::find(kinds_, what, &Kind::what);
    if (kind == kinds_.end()) kind = kinds_.insert(kind, {std::string(what), 0, line});
    ++kind->count;
  }

  std::size_t count(std::string_view what) const {
    const auto kind = std::ranges::find(kinds_, what, &Kind::what);
    return kind == kinds_.end() ? 0 : kind->count;
  }

  void warn(const std::string& file, std::vector<std::string>& warnings) const {
    for (const Kind& kind : kinds_)
      warnings.push_back(file + ":" + std::to_string(kind.line) + ": " + std::to_string(kind.count) + " " +
                         kind.what + " (the first is in this line)");
  }

 private:
  struct Kind {
    std::string what;
    std::size_t count;
    std::uint32_t line;
  };
  std::vector<Kind> kinds_;  // by their first
};

// Reserves memory in a vector for all that the rest of a text will bring, should it go on as it began. Call
// reserve() before each push_back(); the rate is measured from where the vector got its first element. Memory
// that is reserved and not used is never touched, so that too much costs nothing. (Growing by doubling
// touches each element's memory twice and copies it: that took longer than reading the numbers.)
class ReserveAhead {
 public:
  template <class Vector>
  void reserve(Vector& elements, std::size_t bytes_left) {
    const std::size_t n = elements.size();
    if (n < elements.capacity()) return;
    if (n == 0) first_ = bytes_left;
    // So few elements say little about the rest, and are cheap to copy.
    if (n < kFew || first_ <= bytes_left) return;
    const double bytes_each = static_cast<double>(first_ - bytes_left) / static_cast<double>(n);
    const auto more = static_cast<std::size_t>(kSpare * static_cast<double>(bytes_left) / bytes_each);
    elements.reserve(n + std::max(n, more));
  }

 private:
  static constexpr std::size_t kFew = 4096;
  static constexpr double kSpare = 1.05;
  std::size_t first_ = 0;  // bytes left at the first element
};

}  // namespace kdray::scene
