// What    Small meshes as a program's arrays.
#pragma once

#include <cstdint>
#include <vector>

namespace kdray::test {

// The cube from -1 to 1, its faces to the outside.
struct Cube {
  std::vector<float> vertices;
  std::vector<std::uint32_t> triangles{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                       2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

  Cube() {
    for (int i = 0; i < 8; ++i)
      for (int k = 0; k < 3; ++k) vertices.push_back(i >> k & 1 ? 1.0f : -1.0f);
  }
  std::vector<float> at(float x, float y, float z) const {
    std::vector<float> moved = vertices;
    for (std::size_t i = 0; i < moved.size(); i += 3) moved[i] += x, moved[i + 1] += y, moved[i + 2] += z;
    return moved;
  }
};

}  // namespace kdray::test
