// What    What the properties of a PLY file's vertices mean.
// Errors  kdray::Error with the header's line where a vertex has no place.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "scene/ply_header.h"

namespace kdray::scene::ply {

// What each property of a vertex is: 0 1 2 for x y z, 3 4 5 for nx ny nz, 6 7 8 9 for red green blue alpha,
// -1 for what is skipped.
struct VertexColumns {
  std::vector<int> of_property;
  bool has_normals = false, has_colors = false;
  double color_unit = 1;  // a colour of 1 in the file's numbers
};

VertexColumns find_columns(const Element& element, const std::string& file);

// An error in what the header says of an element.
Error element_error(const Element& element, const std::string& file, const std::string& what);

}  // namespace kdray::scene::ply
