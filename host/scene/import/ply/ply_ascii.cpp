#include <charconv>
#include <utility>

#include "scene/import/plain_number.h"
#include "scene/import/ply/ply_source.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::ply {

namespace {

constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

AsciiSource::AsciiSource(std::string_view text, const Header& header, std::string file)
    : at_(text.data() + header.body),
      end_(text.data() + text.size()),
      line_(header.body_line),
      file_(std::move(file)) {}

bool AsciiSource::skip_space() {
  for (; at_ != end_ && is_space(*at_); ++at_) {
    if (*at_ == ' ') continue;
    if (*at_ == '\n' || (*at_ == '\r' && (at_ + 1 == end_ || at_[1] != '\n'))) ++line_;
  }
  return at_ == end_;
}

bool AsciiSource::ends_token(const char* p) const {
  return p == end_ || is_space(*p);
}

void AsciiSource::finish_line() {
  if (!element_) return;
  for (; at_ != end_ && *at_ != '\n' && *at_ != '\r'; ++at_) {
    if (!is_space(*at_)) has_extra_ = true;
  }
}

std::string_view AsciiSource::token() {
  if (skip_space()) {
    throw error("the file ends too soon", "fetch it again, or correct the counts in its header");
  }
  const char* first = at_;
  while (!ends_token(at_)) ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

double AsciiSource::number(Type) {
  double value = 0;
  skip_space();
  if (const char* last = read_plain_number(at_, end_, value); last && ends_token(last)) {
    at_ = last;
    return value;
  }
  const std::string_view word = token();
  if (!read_number_or_nan(word.data(), word.data() + word.size(), value)) {
    throw error("expected a number, found '" + printable(word) + "'");
  }
  return value;
}

std::int64_t AsciiSource::integer(Type) {
  std::int64_t value = 0;
  skip_space();
  if (const char* last = read_plain_whole(at_, end_, value); last && ends_token(last)) {
    at_ = last;
    return value;
  }
  const std::string_view word = token();
  const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || stop != word.data() + word.size()) {
    throw error("expected a whole number, found '" + printable(word) + "'");
  }
  return value;
}

std::uint64_t AsciiSource::list_length(Type, Type) {
  const std::int64_t n = integer(Type::i32);
  if (n < 0) throw error("a list of " + std::to_string(n) + " entries");
  const auto length = static_cast<std::uint64_t>(n);
  if (length > capacity()) {
    throw error("a list of " + std::to_string(n) + " entries, but the file ends before that");
  }
  return length;
}

Error AsciiSource::error(const std::string& what, const std::string& remedy) const {
  std::string where;
  if (element_) where = "element '" + printable(element_->name) + "' " + std::to_string(row_) + ": ";
  return input_error(file_, line_, where + what, remedy);
}

}  // namespace kdray::scene::ply
