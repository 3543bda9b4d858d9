// What    Collects what the rows of a PLY file say into a Scene, in whatever order the elements come.
// Shape   Faces may come before the vertices: triangles are made at once, larger polygons get the numbers of
//         their n - 2 triangles at once and are cut in finish(). Indices are checked against the header's
//         vertex count.
// Errors  None: the functions return false for what a row may not hold; the caller knows the place in the
//         file.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene::ply {

// Red, green, blue and alpha, in the file's numbers.
using VertexColor = std::array<float, 4>;
using TexCoord = std::array<float, 2>;

// An entry for each vertex; normals, colours and texture coordinates may be none.
struct VertexArrays {
  RawVector<dvec3> places;
  RawVector<vec3> normals;
  RawVector<VertexColor> colors;
  RawVector<TexCoord> texcoords;  // v upwards
};

class Mesh {
 public:
  explicit Mesh(std::uint32_t n_vertices) : n_vertices_(n_vertices) {}

  // Returns the arrays, which the caller fills in.
  VertexArrays& vertices() { return vertices_; }
  void set_color_unit(double unit) { color_unit_ = unit; }  // what a colour of 1 is in the file
  PageVector<Triangle>& triangles() { return scene_.triangles; }
  std::uint32_t n_vertices() const { return n_vertices_; }

  // Adds one polygon, with texture coordinates for each corner or none. Returns false when it has a corner
  // that is no vertex. One of fewer than three corners is counted and left out.
  bool add_face(std::span<const std::int64_t> corners, std::span<const TexCoord> texcoords = {});
  // Set the colour and the texture of the triangles from `first` on, which are of one face.
  void color_face(std::size_t first, const VertexColor& color);
  void set_texture(std::size_t first, std::uint32_t texture);
  // Triangles over each three neighbours, every second one turned over; -1 starts a new strip.
  bool add_strip(std::span<const std::int64_t> corners);
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  void warn(const std::string& what) { scene_.warnings.push_back(what); }
  // `file` names the file in warnings.
  Scene finish(const std::string& file);
  std::size_t n_shaded_flat() const { return n_shaded_flat_; }  // once it is finished

 private:
  struct Polygon {
    std::size_t first_triangle;
    std::size_t first_corner;  // in polygon_corners_
    std::uint32_t n_corners;
  };

  using LinearColor = std::array<std::uint32_t, 4>;

  bool is_vertex(std::int64_t index) const { return index >= 0 && index < n_vertices_; }
  void cut_polygons();
  void color_corners();
  void lay_corners();
  LinearColor linear(const VertexColor& color);
  void set_texcoords(std::size_t triangle, std::span<const TexCoord> of,
                     const std::array<std::uint32_t, 3>& pick);

  Scene scene_;
  VertexArrays vertices_;
  double color_unit_ = 1;
  std::uint32_t n_vertices_;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> polygon_corners_;
  std::vector<TexCoord> polygon_texcoords_;  // of the same, or none
  std::size_t n_small_faces_ = 0, n_shaded_flat_ = 0, n_bad_colors_ = 0, n_bad_texcoords_ = 0;
};

inline void Mesh::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Triangle t{.vertex = {a, b, c}};
  t.number = static_cast<std::uint32_t>(scene_.triangles.size());
  scene_.triangles.push_back(t);
}

}  // namespace kdray::scene::ply
