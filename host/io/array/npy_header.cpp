#include "io/array/npy_header.h"

#include <limits>
#include <optional>

#include "base/error.h"

namespace kdray::array {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

// A reader of the few Python literals that a header may hold: strings, lists, tuples, integers, True and
// False.
class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  NpyHeader dictionary() {
    NpyHeader header;
    std::optional<int> seen[3];
    expect('{');
    while (!accept('}')) {
      const std::string key = string();
      expect(':');
      const int which = key == "descr" ? 0 : key == "fortran_order" ? 1 : key == "shape" ? 2 : -1;
      if (which < 0) fail("an unknown key '" + key.substr(0, 40) + "'");
      if (seen[which]) fail("the key '" + key + "' twice");
      seen[which] = 1;
      if (which == 0) type(header);
      if (which == 1) header.fortran_order = boolean();
      if (which == 2) header.shape = tuple();
      if (!accept(',') && !peek('}')) fail("no ',' or '}' after a value");
    }
    for (const auto& s : seen)
      if (!s) fail("not all of the keys 'descr', 'fortran_order' and 'shape'");
    if (skip_spaces(); at_ < text_.size() && text_[at_] != '\0') fail("something after the dictionary");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw input_error(file_, 0, "is a damaged NumPy file: its header has " + what,
                      "save it again with numpy.save");
  }

  void skip_spaces() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  bool peek(char c) {
    skip_spaces();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool accept(char c) {
    if (!peek(c)) return false;
    ++at_;
    return true;
  }
  void expect(char c) {
    if (!accept(c)) fail(std::string("no '") + c + "' where one belongs");
  }
  bool accept_word(std::string_view word) {
    skip_spaces();
    if (!text_.substr(at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }

  std::string string() {
    skip_spaces();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (quote != '\'' && quote != '"') fail("no string where one belongs");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string_view::npos) fail("a string without its end");
    const std::string_view content = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return std::string(content);
  }

  bool boolean() {
    if (accept_word("True")) return true;
    if (accept_word("False")) return false;
    fail("a 'fortran_order' that is neither True nor False");
  }

  std::uint64_t integer() {
    skip_spaces();
    const std::size_t begin = at_;
    std::uint64_t value = 0;
    for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
      const auto digit = static_cast<std::uint64_t>(text_[at_] - '0');
      if (value > (std::numeric_limits<std::uint64_t>::max() - digit) / 10)
        fail("a number that is too large");
      value = 10 * value + digit;
    }
    if (at_ == begin) fail("a 'shape' that is no tuple of counts");
    if (at_ < text_.size() && text_[at_] == 'L') ++at_;  // Python 2 wrote long integers so
    return value;
  }

  std::vector<std::uint64_t> tuple() {
    std::vector<std::uint64_t> values;
    expect('(');
    while (!accept(')')) {
      values.push_back(integer());
      if (!accept(',') && !peek(')')) fail("a 'shape' that is no tuple of counts");
    }
    return values;
  }

  // A structured type is only to be shown, so its text is taken up to the bracket that closes it.
  void type(NpyHeader& header) {
    header.structured = peek('[');
    if (!header.structured) {
      header.type = string();
      return;
    }
    const std::size_t begin = at_;
    int depth = 0;
    do {
      skip_spaces();
      if (at_ >= text_.size()) fail("a 'descr' without its end");
      const char c = text_[at_];
      if (c == '\'' || c == '"') {
        string();
        continue;
      }
      depth += (c == '[' || c == '(') - (c == ']' || c == ')');
      ++at_;
    } while (depth > 0);
    header.type = std::string(text_.substr(begin, at_ - begin));
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
};

std::size_t byte(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

}  // namespace

NpyPreamble parse_preamble(std::string_view start, const std::string& file) {
  if (start.size() < 10 || !start.starts_with(kMagic))
    throw input_error(file, 0, "is not a NumPy file", "write it with numpy.save(file, rays)");
  const std::size_t major = byte(start, 6);
  if (major < 1 || major > 3)
    throw input_error(file, 0, "is a NumPy file of version " + std::to_string(major),
                      "versions 1 to 3 can be read");
  if (major == 1) return {10, byte(start, 8) | byte(start, 9) << 8};
  if (start.size() < 12)
    throw input_error(file, 0, "is cut short in its header", "save it again with numpy.save");
  return {12, byte(start, 8) | byte(start, 9) << 8 | byte(start, 10) << 16 | byte(start, 11) << 24};
}

NpyHeader parse_header(std::string_view text, const std::string& file) {
  return Parser(text, file).dictionary();
}

std::string shape_text(std::span<const std::uint64_t> shape) {
  std::string text = "(";
  for (std::size_t i = 0; i < shape.size() && i < 6; ++i)
    text += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  return text + (shape.size() > 6 ? ", ...)" : shape.size() == 1 ? ",)" : ")");
}

std::string make_header(std::string_view type, std::span<const std::uint64_t> shape) {
  std::string text =
      "{'descr': " + std::string(type) + ", 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
  constexpr std::size_t kPreamble = 10, kAlignment = 64;
  const std::size_t used = kPreamble + text.size() + 1;
  text.append((kAlignment - used % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header(kMagic);
  header += {'\1', '\0', static_cast<char>(text.size() & 255), static_cast<char>(text.size() >> 8)};
  return header + text;
}

}  // namespace kdray::array
