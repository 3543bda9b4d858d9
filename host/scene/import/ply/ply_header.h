// What    The header of a PLY file: which elements follow, with which properties, and how they are stored.
// Errors  kdray::Error with the header's line.
// Source  G. Turk, "The PLY Polygon File Format", 1994; type names in the old and the sized spelling (int,
//         int32).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::scene::ply {

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class Format : std::uint8_t { ascii, little_endian, big_endian };

constexpr std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(Type type) {
  return type != Type::f32 && type != Type::f64;
}

struct Property {
  std::string name;       // a second one of this name has a note behind it, so that find() doesn't take it
  Type type = Type::f32;  // of a list: of its entries
  bool is_list = false;
  Type count_type = Type::u8;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::uint32_t line = 0;
  std::vector<Property> properties;

  bool has_lists() const;
  const Property* find(std::string_view name) const;  // null when there is none
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::vector<std::string> textures;  // pictures, as `comment TextureFile` names them
  std::size_t body = 0;               // offset of the first byte after the header
  std::uint32_t body_line = 1;
};

Header read_header(std::string_view text, const std::string& file);

}  // namespace kdray::scene::ply
