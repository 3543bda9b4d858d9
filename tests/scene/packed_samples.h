// What    A wavy sheet as a glTF file, plain and packed, for tests of what unpacks it: positions, normals,
//         coordinates and colours, each of which tells where on the sheet it belongs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "scene/gltf_samples.h"
#include "scene/model/scene.h"
#include "scene/pictures.h"

namespace kdray::test {

struct Sheet {
  static constexpr int kSide = 12;  // corners along each side
  std::vector<float> positions, normals, coordinates;
  std::vector<std::uint8_t> colors;
  std::vector<std::uint16_t> corners;

  static float height(double x, double y) {
    return static_cast<float>(0.1 * std::sin(5 * x) * std::cos(4 * y));
  }

  Sheet() {
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) add_corner(i, j);
    for (int j = 0; j + 1 < kSide; ++j)
      for (int i = 0; i + 1 < kSide; ++i) add_square(j * kSide + i);
  }
  std::size_t size() const { return positions.size() / 3; }

 private:
  void add_corner(int i, int j) {
    const float x = static_cast<float>(i) / (kSide - 1), y = static_cast<float>(j) / (kSide - 1);
    positions.insert(positions.end(), {x, y, height(x, y)});
    const float length = std::sqrt(x * x + y * y + 1);
    normals.insert(normals.end(), {x / length, y / length, 1 / length});
    coordinates.insert(coordinates.end(), {x, 1 - y});
    colors.insert(colors.end(),
                  {static_cast<std::uint8_t>(i * 20), static_cast<std::uint8_t>(j * 20), 7, 255});
  }
  void add_square(int at) {
    for (const int corner : {at, at + 1, at + kSide, at + 1, at + kSide + 1, at + kSide})
      corners.push_back(static_cast<std::uint16_t>(corner));
  }
};

// A material with a picture, so that coordinates and colours are read.
inline void add_picture(GltfSample& sample) {
  sample.json["images"] = {{{"uri", "data:image/png;base64," + base64(four_colors())}}};
  sample.json["textures"] = {{{"source", 0}}};
  sample.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  sample.primitive()["material"] = 0;
}

// The file without packing.
inline GltfSample plain(const Sheet& sheet) {
  GltfSample sample;
  auto& attributes = sample.primitive()["attributes"];
  attributes["POSITION"] = sample.vectors(sheet.positions);
  attributes["NORMAL"] = sample.vectors(sheet.normals);
  attributes["TEXCOORD_0"] =
      sample.accessor(sample.view(bytes_of(sheet.coordinates)), 5126, "VEC2", sheet.size());
  const int colors = sample.accessor(sample.view(bytes_of(sheet.colors)), 5121, "VEC4", sheet.size());
  sample.json["accessors"][static_cast<std::size_t>(colors)]["normalized"] = true;
  attributes["COLOR_0"] = colors;
  sample.primitive()["indices"] = sample.indices(sheet.corners);
  add_picture(sample);
  return sample;
}

// Which corner of the sheet a vertex is.
inline int place_of(const dvec3& v) {
  return static_cast<int>(std::lround(v.x * (Sheet::kSide - 1))) +
         Sheet::kSide * static_cast<int>(std::lround(v.y * (Sheet::kSide - 1)));
}

// The sheet's triangles, each beginning with its lowest corner.
inline std::multiset<std::array<int, 3>> triangles_of(const std::function<int(std::size_t)>& corner,
                                                      std::size_t n) {
  std::multiset<std::array<int, 3>> out;
  for (std::size_t i = 0; i + 2 < n; i += 3) {
    std::array<int, 3> t = {corner(i), corner(i + 1), corner(i + 2)};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.insert(t);
  }
  return out;
}

}  // namespace kdray::test
