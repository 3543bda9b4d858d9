// What    Pictures in memory: linear RGB float, row by row from the top left, with alpha where a picture has
//         it; and named extra channels (AOVs).
#pragma once

#include <string>
#include <vector>

#include "base/vec.h"

namespace kdray::image {

struct Image {
  int width = 0, height = 0;
  std::vector<vec3> pixels;  // width * height, row 0 is the top
  // The share of each pixel that is covered; `pixels` are multiplied by it already. Empty: all of each pixel.
  std::vector<float> alpha = {};
  // Where it lies in a picture of that size, of which it is a part. 0: it is the whole.
  int x = 0, y = 0, whole_width = 0, whole_height = 0;
};

// One float channel beside the colour, as wide and high as the picture: "depth" (multiples of the unit-length
// ray direction, inf where nothing is hit), "normal.x" ".y" ".z" (unit, 0 where nothing is hit), "primitive"
// (number, -1 where nothing is hit), "cost" (nodes visited + primitives tested), "queue" (color.h).
struct Channel {
  std::string name;
  std::vector<float> values;
  std::string manifest = {};  // JSON: what the numbers are called; kept in an EXR
};

}  // namespace kdray::image
