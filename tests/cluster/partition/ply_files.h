// What    Binary PLY files of meshes for the tests: a bumpy ball, with normals and colours if wanted.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

namespace kdray::test {

struct PlyParts {
  bool normals = false, colors = false;
  bool big_endian = false;
  bool quality = false;  // which nothing is made of
};

class PlyWriter {
 public:
  PlyWriter(std::size_t n_vertices, std::size_t n_faces, const PlyParts& parts) : parts_(parts) {
    text_ = std::string("ply\nformat binary_") + (parts.big_endian ? "big" : "little") + "_endian 1.0\n" +
            "element vertex " + std::to_string(n_vertices) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
    if (parts.normals) text_ += "property float nx\nproperty float ny\nproperty float nz\n";
    if (parts.colors) text_ += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    if (parts.quality) text_ += "property float quality\n";
    text_ +=
        "element face " + std::to_string(n_faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
  }

  void vertex(float x, float y, float z, std::uint32_t color = 0) {
    for (const float value : {x, y, z}) put(value);
    if (parts_.normals)
      for (const float value : {x, y, z}) put(value);
    if (parts_.colors)
      for (int k = 0; k < 3; ++k) text_ += static_cast<char>(color >> 8 * k);
    if (parts_.quality) put(0.5f);
  }
  void face(std::int32_t a, std::int32_t b, std::int32_t c) {
    text_ += '\3';
    for (const std::int32_t corner : {a, b, c}) put(corner);
  }
  const std::string& text() const { return text_; }

 private:
  template <class T>
  void put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof value);
    for (std::size_t i = 0; i < sizeof(T); ++i) text_ += bytes[parts_.big_endian ? sizeof(T) - 1 - i : i];
  }

  PlyParts parts_;
  std::string text_;
};

// 2 * rows * rows * 2 faces, the first of them degenerate where wanted.
inline std::string ball_ply(int rows, const PlyParts& parts, bool with_degenerate = false) {
  const int columns = 2 * rows;
  const int n_faces = 2 * rows * columns;
  PlyWriter ply(static_cast<std::size_t>((rows + 1) * columns + 1), static_cast<std::size_t>(n_faces), parts);
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double a = 3.14159265 * i / rows, b = 2 * 3.14159265 * j / columns,
                   r = 1 + 0.1 * std::sin(7 * b) * std::sin(5 * a);
      ply.vertex(static_cast<float>(r * std::sin(a) * std::cos(b)), static_cast<float>(r * std::cos(a)),
                 static_cast<float>(r * std::sin(a) * std::sin(b)),
                 static_cast<std::uint32_t>(i * 77 + j * 3001));
    }
  ply.vertex(1e6f, 0, 0);  // which no face uses
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const int a = i * columns + j, b = i * columns + (j + 1) % columns;
      ply.face(a, b, b + columns);
      ply.face(a, with_degenerate && i + j == 3 ? a : b + columns, a + columns);
    }
  return ply.text();
}

}  // namespace kdray::test
