#include "scene/import/text_scanner.h"

#include <charconv>
#include <cstdlib>
#include <limits>
#include <utility>

#include "scene/import/lower.h"
#include "scene/import/plain_number.h"

namespace kdray::scene {

namespace {

constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

constexpr bool starts_number(char c) {
  return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
}

// from_chars calls both too large and too small "out of range"; strtod tells them apart. Rare, so the copy is
// fine.
bool read_extreme(const char* first, const char* last, double& value) {
  value = std::strtod(std::string(first, last).c_str(), nullptr);
  return std::isfinite(value);
}

}  // namespace

bool read_number(const char* first, const char* last, double& value) {
  if (first != last && *first == '+' && last - first > 1 && first[1] != '-') ++first;
  const auto [stop, code] = std::from_chars(first, last, value);
  if (stop != last || code == std::errc::invalid_argument) return false;
  if (code == std::errc::result_out_of_range) return read_extreme(first, last, value);
  return std::isfinite(value);
}

bool read_number_or_nan(const char* first, const char* last, double& value) {
  if (read_number(first, last, value)) return true;
  std::string word = lower(std::string_view(first, static_cast<std::size_t>(last - first)));
  if (word.starts_with('-') || word.starts_with('+')) word.erase(0, 1);
  double number = 0;
  const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), number);
  const bool too_large = code == std::errc::result_out_of_range && stop == word.data() + word.size();
  if (!too_large && word != "nan" && word != "inf" && word != "infinity" && !word.starts_with("nan(") &&
      !word.starts_with("1.#"))
    return false;
  value = std::numeric_limits<double>::quiet_NaN();
  return true;
}

std::string printable(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  std::string shown(token.substr(0, kLongest));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  if (token.size() > kLongest) shown += "...";
  return shown;
}

TextScanner::TextScanner(std::string_view text, std::string file)
    : at_(text.data()), end_(text.data() + text.size()), file_(std::move(file)) {
  if (text.starts_with("\xef\xbb\xbf")) at_ += 3;  // a UTF-8 byte order mark
}

void TextScanner::skip_space() {
  for (; at_ != end_; ++at_) {
    const char c = *at_;
    if (c == ' ') continue;
    if (c == '#') {
      while (at_ + 1 != end_ && at_[1] != '\n' && at_[1] != '\r') ++at_;
    } else if (c == '\n' || (c == '\r' && (at_ + 1 == end_ || at_[1] != '\n'))) {
      ++line_;
    } else if (!is_space(c)) {
      return;
    }
  }
}

bool TextScanner::ends_token(const char* p) const {
  return p == end_ || is_space(*p) || *p == '#';
}

const char* TextScanner::token_end() const {
  const char* p = at_;
  while (!ends_token(p)) ++p;
  return p;
}

bool TextScanner::at_end() {
  skip_space();
  return at_ == end_;
}

std::string_view TextScanner::peek() {
  skip_space();
  return {at_, static_cast<std::size_t>(token_end() - at_)};
}

std::string_view TextScanner::word(std::string_view what) {
  const std::string_view token = peek();
  if (token.empty()) throw expected(what);
  at_ += token.size();
  last_line_ = line_;
  return token;
}

bool TextScanner::at_number() {
  skip_space();
  return at_ != end_ && starts_number(*at_);
}

double TextScanner::number(std::string_view what, NotFinite other) {
  skip_space();
  double value = 0;
  const char* last = read_plain_number(at_, end_, value);
  if (last == nullptr || !ends_token(last)) {
    last = token_end();
    const auto read = other == NotFinite::nan ? read_number_or_nan : read_number;
    if (!read(at_, last, value)) throw expected(what);
  }
  at_ = last;
  last_line_ = line_;
  return value;
}

dvec3 TextScanner::vector(std::string_view what, NotFinite other) {
  const double x = number(what, other);
  const double y = number(what, other);
  const double z = number(what, other);
  return {x, y, z};
}

std::uint32_t TextScanner::count(std::string_view what) {
  skip_space();
  const char* last = token_end();
  std::uint32_t value = 0;
  const auto [stop, code] = std::from_chars(at_, last, value);
  if (stop != last || code != std::errc()) throw expected(what);
  at_ = last;
  last_line_ = line_;
  return value;
}

Error TextScanner::error(const std::string& what, const std::string& remedy) const {
  return input_error(file_, line_, what, remedy);
}

Error TextScanner::expected(std::string_view what) {
  const std::string_view token = peek();
  const std::string wanted = "expected " + std::string(what);
  if (token.empty()) return input_error(file_, last_line_, wanted + ", but the file ends here");
  return error(wanted + ", found '" + printable(token) + "'");
}

}  // namespace kdray::scene
