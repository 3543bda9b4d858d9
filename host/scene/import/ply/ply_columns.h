// What    What the properties of a PLY file's vertices and faces mean, and which elements and properties are
//         left out.
// Errors  kdray::Error with the header's line where a vertex has no place.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/import/ply/ply_header.h"

namespace kdray::scene::ply {

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
