// What    What the properties of a PLY file's vertices and faces mean.
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

// Texture coordinates count where the file names a picture, and faces don't have them.
VertexColumns find_columns(const Header& header, const Element& element, const std::string& file);

// What is read of a face beside its corners; null: not there, or vertices have it.
struct FaceColumns {
  std::array<const Property*, 4> color{};  // red, green, blue, and alpha or null
  const Property* texcoords = nullptr;     // a list of u and v for each corner
  const Property* texture = nullptr;       // the number of its picture
  double color_unit = 1;

  bool any() const { return color[0] || texcoords || texture; }
  bool reads(const Property& p) const;
};

FaceColumns find_face_columns(const Header& header, const Element& element);

// An error in what the header says of an element.
Error element_error(const Element& element, const std::string& file, const std::string& what);

}  // namespace kdray::scene::ply
