#include "scene/import/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <utility>

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

namespace {

struct Character {
  std::size_t bytes = 1;
  std::uint32_t code = 0;  // 0: no UTF-8
};

// Returns the character that a text begins with. Source: RFC 3629.
Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) -> std::uint32_t { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {1, byte(0)};
  const std::size_t n = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < n) return {};
  std::uint32_t code = byte(0) & (0x7fu >> n);
  for (std::size_t i = 1; i < n; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr std::uint32_t kLeast[] = {0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return code < kLeast[n - 2] || code > 0x10ffff || surrogate ? Character{} : Character{n, code};
}

bool may_be_shown(std::uint32_t code) {
  if (code < 0x20 || (code >= 0x7f && code < 0xa0)) return false;
  const bool directs = code == 0x61c || code == 0x200e || code == 0x200f ||
                       (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return !directs;
}

}  // namespace

std::string printable(std::string_view token, std::size_t longest) {
  const auto plain =
      std::ranges::find_if(token, [](char c) { return c < 0x20 || c >= 0x7f; }) - token.begin();
  if (static_cast<std::size_t>(plain) == token.size() && plain <= static_cast<std::ptrdiff_t>(longest))
    return std::string(token);  // as nearly all are
  std::string shown;
  while (!token.empty()) {
    const Character c = first_character(token);
    if (shown.size() + c.bytes > longest) return shown + "...";
    shown.append(may_be_shown(c.code) ? token.substr(0, c.bytes) : "?");
    token.remove_prefix(c.bytes);
  }
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

// ---- LineScanner

namespace {

constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
constexpr bool is_end(char c) {
  return c == '\n' || c == '\r';
}

}  // namespace

LineScanner::LineScanner(std::string_view text, std::string file) : file_(std::move(file)) {
  if (text.starts_with("\xfe\xff") || text.starts_with("\xff\xfe")) {
    throw input_error(file_, 1, "this is UTF-16 text", "save it as UTF-8");
  }
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  at_ = text.data();
  end_ = at_ + text.size();
}

// Returns the end of a backslash and line end at `p`, with the blanks between them; null where there is no
// such join.
const char* LineScanner::end_of_join(const char* p) const {
  if (*p != '\\') return nullptr;
  do ++p;
  while (p != end_ && is_blank(*p));
  if (p == end_ || !is_end(*p)) return nullptr;
  return *p == '\r' && p + 1 != end_ && p[1] == '\n' ? p + 2 : p + 1;
}

bool LineScanner::ends_word(const char* p) const {
  return p == end_ || is_blank(*p) || is_end(*p) || end_of_join(p);
}

void LineScanner::skip_space() {
  while (at_ != end_) {
    if (is_blank(*at_)) {
      ++at_;
    } else if (const char* const joined = end_of_join(at_)) {
      at_ = joined;
      ++line_;
    } else {
      return;
    }
  }
}

bool LineScanner::next_line() {
  if (started_) {
    while (at_ != end_ && !is_end(*at_)) {
      if (end_of_join(at_)) {
        skip_space();
      } else {
        ++at_;
      }
    }
    if (at_ == end_) return false;
    at_ += *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n' ? 2 : 1;
  }
  started_ = true;
  ++line_;
  return at_ != end_;
}

std::string_view LineScanner::word() {
  skip_space();
  if (at_ != end_ && *at_ == '#') {
    // A comment is not joined to the next line: a backslash at its end is more likely the end of a Windows
    // path.
    while (at_ != end_ && !is_end(*at_)) ++at_;
  }
  const char* first = at_;
  // Most characters need one comparison: what may end a word is a backslash or not above ' '.
  for (; at_ != end_; ++at_) {
    const bool inside = *at_ > ' ' && *at_ != '\\';
    if (!inside && ends_word(at_)) break;
  }
  return {first, static_cast<std::size_t>(at_ - first)};
}

std::string_view LineScanner::plain_whole(std::int64_t& value) {
  skip_space();
  const char* const first = at_;
  const char* const last = read_plain_whole(first, end_, value);
  if (last == nullptr || !ends_word(last)) return {};
  at_ = last;
  return {first, static_cast<std::size_t>(last - first)};
}

std::string_view LineScanner::rest() {
  skip_space();
  joined_.clear();
  const char* first = at_;
  while (at_ != end_ && !is_end(*at_)) {
    if (!end_of_join(at_)) {
      ++at_;
    } else {
      joined_.append(first, at_).append(" ");
      skip_space();
      first = at_;
    }
  }
  std::string_view found(first, static_cast<std::size_t>(at_ - first));
  if (!joined_.empty()) found = joined_.append(found);
  while (!found.empty() && is_blank(found.back())) found.remove_suffix(1);
  return found;
}

bool LineScanner::try_number(std::string_view what, double& value, NotFinite other) {
  skip_space();
  double plain = 0;
  if (const char* last = read_plain_number(at_, end_, plain); last && ends_word(last)) {
    at_ = last;
    value = plain;
    return true;
  }
  const std::string_view found = word();
  if (found.empty()) return false;
  const auto read = other == NotFinite::nan ? read_number_or_nan : read_number;
  if (!read(found.data(), found.data() + found.size(), value)) {
    throw error("expected " + std::string(what) + " (a finite number), found '" + printable(found) + "'");
  }
  return true;
}

double LineScanner::number(std::string_view what, NotFinite other) {
  double value = 0;
  if (!try_number(what, value, other))
    throw error("expected " + std::string(what) + ", but the line ends here");
  return value;
}

Error LineScanner::error(const std::string& what, const std::string& remedy) const {
  return input_error(file_, line_, what, remedy);
}

}  // namespace kdray::scene
