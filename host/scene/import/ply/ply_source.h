// What    Where the values of a PLY file's rows come from: text (AsciiSource) or bytes (BinarySource). Both
//         have the same functions, and ply.cpp reads rows from either.
// Shape   number, integer and skip take the next value; a number may be infinite or NaN. list_length takes
//         the next list's length and checks it against what is left of the file, so that nothing is allocated
//         for entries that aren't there.
// Errors  ascii: "file:line: ..."; binary: "file: element 'face' 17, byte 4711: ...".
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/vec.h"
#include "scene/import/ply/ply_header.h"
#include "scene/import/ply/ply_mesh.h"

namespace kdray::scene::ply {

class AsciiSource {
 public:
  static constexpr bool kBinary = false;

  AsciiSource(std::string_view text, const Header& header, std::string file);

  double number(Type type);
  std::int64_t integer(Type type);
  void skip(Type) { token(); }
  std::uint64_t list_length(Type count_type, Type entry_type);

  // Return the most values that can still follow, and the fewest that a row takes.
  std::uint64_t capacity() const { return (static_cast<std::uint64_t>(end_ - at_) + 1) / 2; }
  static std::uint64_t least_size(const Element& element) { return element.properties.size(); }

  // A row has a line of its own; values on it that the header doesn't know are skipped.
  void begin_row(const Element& element, std::uint64_t row) {
    finish_line();
    element_ = &element, row_ = row;
  }
  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const;
  // Returns whether only white space is left; called after the last row.
  bool at_end() {
    finish_line();
    return skip_space();
  }
  bool has_extra_values() const { return has_extra_; }

 private:
  std::string_view token();
  bool skip_space();  // true at the end of the text
  bool ends_token(const char* p) const;
  void finish_line();

  const char* at_;
  const char* end_;
  std::uint32_t line_;
  std::string file_;
  const Element* element_ = nullptr;  // null before the first row
  std::uint64_t row_ = 0;
  bool has_extra_ = false;
};

inline constexpr bool kLittleEndianHost = std::endian::native == std::endian::little;

// Returns the value that a file's bytes stand for on this machine.
template <class T, bool swap>
T load(const unsigned char* bytes) {
  unsigned char raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

// Calls `use` with a value of the C++ type that `type` stands for.
template <class Use>
auto with_type(Type type, const Use& use) {
  switch (type) {
    case Type::i8:
      return use(std::int8_t{});
    case Type::u8:
      return use(std::uint8_t{});
    case Type::i16:
      return use(std::int16_t{});
    case Type::u16:
      return use(std::uint16_t{});
    case Type::i32:
      return use(std::int32_t{});
    case Type::u32:
      return use(std::uint32_t{});
    case Type::f32:
      return use(float{});
    case Type::f64:
      break;
  }
  return use(double{});
}

template <bool swap>
class BinarySource {
 public:
  static constexpr bool kBinary = true;

  BinarySource(std::string_view text, const Header& header, std::string file)
      : begin_(reinterpret_cast<const unsigned char*>(text.data())),
        at_(begin_ + header.body),
        last_(at_),
        end_(begin_ + text.size()),
        file_(std::move(file)) {}

  double number(Type type) {
    const unsigned char* bytes = take(size_of(type));
    return with_type(type, [&](auto t) { return double(load<decltype(t), swap>(bytes)); });
  }
  std::int64_t integer(Type type) {
    const unsigned char* bytes = take(size_of(type));
    return with_type(type, [&](auto t) { return static_cast<std::int64_t>(load<decltype(t), swap>(bytes)); });
  }
  void skip(Type type) { take(size_of(type)); }
  std::uint64_t list_length(Type count_type, Type entry_type) {
    const std::int64_t n = integer(count_type);
    if (n < 0) throw error("a list of " + std::to_string(n) + " entries");
    const auto length = static_cast<std::uint64_t>(n);
    if (length > capacity() / size_of(entry_type)) throw too_short();
    return length;
  }

  std::uint64_t capacity() const { return static_cast<std::uint64_t>(end_ - at_); }
  static std::uint64_t least_size(const Element& element) {
    std::uint64_t size = 0;
    for (const Property& p : element.properties) size += size_of(p.is_list ? p.count_type : p.type);
    return size;
  }

  void begin_row(const Element& element, std::uint64_t row) { element_ = &element, row_ = row, last_ = at_; }
  [[nodiscard]] Error error(const std::string& what, const std::string& remedy = "") const {
    std::string where;
    if (element_) where = "element '" + element_->name + "' " + std::to_string(row_) + ", ";
    return input_error(file_, 0, where + "byte " + std::to_string(last_ - begin_) + ": " + what, remedy);
  }
  bool at_end() const { return at_ == end_; }
  static constexpr bool has_extra_values() { return false; }

  // The bytes not yet taken, for the fast paths.
  const unsigned char* at() const { return at_; }
  const unsigned char* end() const { return end_; }
  void advance(std::size_t n) { at_ += n; }

 private:
  const unsigned char* take(std::size_t n) {
    last_ = at_;
    if (static_cast<std::size_t>(end_ - at_) < n) throw too_short();
    at_ += n;
    return last_;
  }
  [[nodiscard]] Error too_short() const {
    return error("the file ends too soon", "fetch it again, or correct the counts in its header");
  }

  const unsigned char* begin_;
  const unsigned char* at_;
  const unsigned char* last_;  // where the value begins that was taken last
  const unsigned char* end_;
  std::string file_;
  const Element* element_ = nullptr;
  std::uint64_t row_ = 0;
};

// ---- The fast paths of binary files: vertices without lists, column by column, and faces that are nothing
// but triangles of 32-bit indices after a one-byte count. Everything else ply.cpp reads value by value.

// Fills the arrays that there are columns for, which have element.count entries, for which the source has the
// bytes. Returns false where some value is not finite.
template <bool swap>
bool read_columns(BinarySource<swap>& source, const Element& element, const VertexColumns& columns,
                  VertexArrays& out);

// Reads rows as long as they are good triangles, and returns their number.
template <bool swap>
std::uint64_t read_triangles(BinarySource<swap>& source, const Element& element, Mesh& mesh);

}  // namespace kdray::scene::ply
