#include "scene/import/ply/ply_source.h"

#include <algorithm>
#include <charconv>
#include <type_traits>
#include <utility>

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

namespace {

// Rows converted at a time: few enough that the bytes of a block stay in the first-level cache from one
// column to the next.
constexpr std::uint64_t kBlock = 512;
constexpr std::size_t kTriangleBytes = 13;

// Converts one column of a block; returns false when a value is not finite.
template <class T, bool swap, class Out>
bool convert(const unsigned char* bytes, std::size_t stride, std::uint64_t n, Out* out,
             std::size_t out_stride) {
  unsigned bad = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    const auto value = static_cast<Out>(load<T, swap>(bytes + i * stride));
    if constexpr (std::is_floating_point_v<T>) bad |= !std::isfinite(value);
    out[i * out_stride] = value;
  }
  return bad == 0;
}

}  // namespace

template <bool swap>
bool read_columns(BinarySource<swap>& source, const Element& element, const VertexColumns& columns,
                  VertexArrays& out) {
  const std::size_t stride = BinarySource<swap>::least_size(element);
  bool good = true;
  for (std::uint64_t row = 0; row < element.count; row += kBlock) {
    const std::uint64_t n = std::min(kBlock, element.count - row);
    std::size_t offset = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Type type = element.properties[i].type;
      const unsigned char* bytes = source.at() + offset;
      const int column = columns.of_property[i];
      offset += size_of(type);
      if (column < 0) continue;
      const auto at = static_cast<std::size_t>(column);
      const bool finite = with_type(type, [&](auto t) {
        using T = decltype(t);
        if (at < 3) return convert<T, swap>(bytes, stride, n, &out.places[row][column], 3);
        if (at < 6) return convert<T, swap>(bytes, stride, n, &out.normals[row][column - 3], 3);
        if (at < 10) return convert<T, swap>(bytes, stride, n, &out.colors[row][at - 6], 4);
        return convert<T, swap>(bytes, stride, n, &out.texcoords[row][at - 10], 2);
      });
      good = good && finite;
    }
    source.advance(n * stride);
  }
  return good;
}

template <bool swap>
std::uint64_t read_triangles(BinarySource<swap>& source, const Element& element, Mesh& mesh) {
  const Property& list = element.properties[0];
  const bool fits = element.properties.size() == 1 && size_of(list.count_type) == 1 &&
                    (list.type == Type::i32 || list.type == Type::u32);
  if (!fits) return 0;
  const auto* at = source.at();
  const std::uint64_t n =
      std::min(element.count, static_cast<std::uint64_t>(source.end() - at) / kTriangleBytes);
  const std::uint32_t n_vertices = mesh.n_vertices();
  auto& triangles = mesh.triangles();
  triangles.reserve(triangles.size() + n);
  std::uint64_t row = 0;
  for (; row < n; ++row, at += kTriangleBytes) {
    // A negative index is a large one here.
    const auto a = load<std::uint32_t, swap>(at + 1);
    const auto b = load<std::uint32_t, swap>(at + 5);
    const auto c = load<std::uint32_t, swap>(at + 9);
    if (at[0] != 3 || std::max({a, b, c}) >= n_vertices) break;
    mesh.add_triangle(a, b, c);
  }
  source.advance(row * kTriangleBytes);
  return row;
}

template bool read_columns(BinarySource<false>&, const Element&, const VertexColumns&, VertexArrays&);
template bool read_columns(BinarySource<true>&, const Element&, const VertexColumns&, VertexArrays&);
template std::uint64_t read_triangles(BinarySource<false>&, const Element&, Mesh&);
template std::uint64_t read_triangles(BinarySource<true>&, const Element&, Mesh&);

}  // namespace kdray::scene::ply
