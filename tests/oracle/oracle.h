// What    Pictures by the oracle: the independent, slow, double-precision answer that kdray's pictures are
//         held against, with the pixels marked whose answer hangs on a hair.
// Shape   trace_picture: width * height pixels, row by row from the top left.
#pragma once

#include <vector>

#include "oracle/whitted.h"

namespace kdray::oracle {

enum class Grid { centers, corners };  // corners: the outermost rays go through the picture's edges

struct OracleResult {
  int width = 0, height = 0;
  std::vector<dvec3> rgb;          // linear
  std::vector<std::uint8_t> edge;  // 1: a hundredth of a pixel aside, the ray tree takes another path
  std::vector<double> spread;  // how far the colour moves over that hundredth of a pixel, per channel at most
  RayCounts counts;            // of the rays through the pixels themselves
};

// `scene` must have a camera.
OracleResult trace_picture(const scene::Scene& scene, int width, int height, int depth,
                           Grid grid = Grid::centers);

// The eye ray through the picture plane at (x, y), in pixels from the upper left corner.
Ray eye_ray(const scene::Camera& camera, double x, double y, int width, int height);

}  // namespace kdray::oracle
