#include "scene/import/line_scanner.h"

#include <utility>

#include "scene/import/plain_number.h"

namespace kdray::scene {

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

// Where a backslash and a line end that stand at `p` end, with what blanks are between; null: they don't.
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
  // Most characters are told at once: what may end a word is a backslash or not above ' '.
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
