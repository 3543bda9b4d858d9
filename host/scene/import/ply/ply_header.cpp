#include "scene/import/ply/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/text_scanner.h"

namespace kdray::scene::ply {

namespace {

// A header line longer than this, or a header of more lines, is a file that isn't a PLY file at all.
constexpr std::size_t kLongestLine = 4096;
constexpr std::uint32_t kMostLines = 100'000;

constexpr std::array<std::pair<std::string_view, Type>, 16> kTypes = {{{"char", Type::i8},
                                                                       {"int8", Type::i8},
                                                                       {"uchar", Type::u8},
                                                                       {"uint8", Type::u8},
                                                                       {"short", Type::i16},
                                                                       {"int16", Type::i16},
                                                                       {"ushort", Type::u16},
                                                                       {"uint16", Type::u16},
                                                                       {"int", Type::i32},
                                                                       {"int32", Type::i32},
                                                                       {"uint", Type::u32},
                                                                       {"uint32", Type::u32},
                                                                       {"float", Type::f32},
                                                                       {"float32", Type::f32},
                                                                       {"double", Type::f64},
                                                                       {"float64", Type::f64}}};

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  Header read() {
    if (!next_line() || word() != "ply") {
      throw error("not a PLY file", "its first line must be 'ply'");
    }
    while (true) {
      if (!next_line()) throw error("the header ends without 'end_header'");
      const std::string_view keyword = word();
      if (keyword == "end_header") break;
      read_line(keyword);
    }
    if (!has_format_) throw error("the header has no 'format' line");
    header_.body = at_;
    header_.body_line = line_ + 1;
    return std::move(header_);
  }

 private:
  void read_line(std::string_view keyword) {
    if (keyword == "comment") return read_comment();
    if (keyword.empty() || keyword == "obj_info") return;
    if (keyword == "format") return read_format();
    if (keyword == "element") return read_element();
    if (keyword == "property") return read_property();
    throw error("expected format, element, property, comment or end_header, found '" + printable(keyword) +
                "'");
  }

  // MeshLab's way to name a texture.
  void read_comment() {
    if (!same_word(word(), "TextureFile")) return;
    std::string_view name = rest_.substr(std::min(rest_.find_first_not_of(" \t"), rest_.size()));
    name = unquoted(name.substr(0, name.find_last_not_of(" \t") + 1));
    FilesRead::add_named(file_, name);
    if (!name.empty() && name.find('\0') == std::string_view::npos) header_.textures.emplace_back(name);
  }

  void read_format() {
    const std::string_view name = word();
    if (name == "ascii") {
      header_.format = Format::ascii;
    } else if (name == "binary_little_endian") {
      header_.format = Format::little_endian;
    } else if (name == "binary_big_endian") {
      header_.format = Format::big_endian;
    } else {
      throw error("expected ascii, binary_little_endian or binary_big_endian, found '" + printable(name) +
                  "'");
    }
    const std::string_view version = word();
    if (version != "1.0") throw error("expected the version 1.0, found '" + printable(version) + "'");
    has_format_ = true;
  }

  void read_element() {
    Element e;
    e.name = word();
    e.line = line_;
    const std::string_view count = word();
    const auto [stop, code] = std::from_chars(count.data(), count.data() + count.size(), e.count);
    if (e.name.empty() || code != std::errc() || stop != count.data() + count.size()) {
      throw error("expected an element's name and how many there are", "write it as 'element vertex 8'");
    }
    const bool twice = std::ranges::find(header_.elements, e.name, &Element::name) != header_.elements.end();
    if (twice) throw error("a second element '" + printable(e.name) + "'");
    header_.elements.push_back(std::move(e));
  }

  void read_property() {
    if (header_.elements.empty()) throw error("a property before the first element");
    Property p;
    std::string_view type = word();
    p.is_list = type == "list";
    if (p.is_list) {
      p.count_type = type_of(word());
      if (!is_integer(p.count_type)) throw error("the length of a list is not of an integer type");
      type = word();
    }
    p.type = type_of(type);
    p.name = word();
    if (p.name.empty()) throw error("a property without a name");
    Element& element = header_.elements.back();
    if (element.find(p.name)) p.name += " (its second)";
    element.properties.push_back(std::move(p));
  }

  Type type_of(std::string_view name) const {
    const auto* it = std::ranges::find(kTypes, name, &std::pair<std::string_view, Type>::first);
    if (it == kTypes.end()) {
      throw error("expected a type (char uchar short ushort int uint float double), found '" +
                  printable(name) + "'");
    }
    return it->second;
  }

  // Lines end in \n, \r\n or \r. After a lone \r the body begins at once, whatever its first byte: in a file
  // whose first line ends in a lone \r, a \n there is data.
  bool next_line() {
    if (at_ >= text_.size()) return false;
    ++line_;
    const std::size_t end = text_.substr(0, at_ + kLongestLine).find_first_of("\r\n", at_);
    if (end == std::string_view::npos || line_ > kMostLines) {
      throw error("the header has no end", "is this a PLY file?");
    }
    rest_ = text_.substr(at_, end - at_);
    at_ = end + 1;
    const bool crlf = text_[end] == '\r' && at_ < text_.size() && text_[at_] == '\n';
    if (line_ == 1) lone_cr_ = text_[end] == '\r' && !crlf;
    if (crlf && !lone_cr_) ++at_;
    return true;
  }

  std::string_view word() {
    const std::size_t first = rest_.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    rest_.remove_prefix(first);
    const std::size_t length = std::min(rest_.find_first_of(" \t"), rest_.size());
    const std::string_view found = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return found;
  }

  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const {
    return input_error(file_, std::max<std::uint32_t>(line_, 1), what, remedy);
  }

  std::string_view text_;
  const std::string& file_;
  Header header_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 0;
  std::string_view rest_;  // of the line
  bool has_format_ = false;
  bool lone_cr_ = false;
};

}  // namespace

bool Element::has_lists() const {
  return std::ranges::any_of(properties, &Property::is_list);
}

const Property* Element::find(std::string_view property) const {
  const auto it = std::ranges::find(properties, property, &Property::name);
  return it == properties.end() ? nullptr : &*it;
}

Header read_header(std::string_view text, const std::string& file) {
  return HeaderReader(text, file).read();
}

}  // namespace kdray::scene::ply
