// What    The header of a PLY file: which elements follow, with which properties, and how they are stored.
// Errors  kdray::Error with the header's line.
// Source  G. Turk, "The PLY Polygon File Format", 1994; type names in the old and the sized spelling (int,
//         int32).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

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

// What the properties of a PLY file's vertices and faces mean, and which elements and properties are left
// out. Errors: kdray::Error with the header's line where a vertex has no place.

// What each property of a vertex is: 0 1 2 for x y z, 3 4 5 for nx ny nz, 6 7 8 9 for red green blue alpha,
// 10 11 for texture coordinates, -1 for what is skipped.
struct VertexColumns {
  std::vector<int> of_property;
  bool has_normals = false, has_colors = false, has_texcoords = false;
  double color_unit = 1;  // a colour of 1 in the file's numbers
};
inline constexpr std::size_t kColumns = 12;

// Finds a vertex' columns. Texture coordinates count where the file names a picture, and faces don't have
// them.
VertexColumns find_columns(const Header& header, const Element& element, const std::string& file);

// What is read of a face beside its corners; null where it is not there, or where vertices have it.
struct FaceColumns {
  std::array<const Property*, 4> color{};  // red, green, blue, and alpha or null
  const Property* texcoords = nullptr;     // a list of u and v for each corner
  const Property* texture = nullptr;       // the number of its picture
  double color_unit = 1;

  bool any() const { return color[0] || texcoords || texture; }
  bool reads(const Property& p) const;
};

FaceColumns find_face_columns(const Header& header, const Element& element);

// Returns an error in what the header says of an element.
Error element_error(const Element& element, const std::string& file, const std::string& what);

// Returns the elements and properties of a header that are left out, by name and number.
std::vector<std::string> left_out_of(const Header& header, const std::string& file);

}  // namespace kdray::scene::ply
