#include "scene/ply_mesh.h"

#include <algorithm>

#include "scene/add_polygon.h"
#include "scene/mesh_material.h"
#include "scene/settle_normals.h"
#include "scene/triangulate.h"

namespace kdray::scene::ply {

bool Mesh::add_face(std::span<const std::int64_t> corners) {
  if (!std::ranges::all_of(corners, [&](std::int64_t c) { return is_vertex(c); })) return false;
  const auto corner = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  if (corners.size() < 3) {
    ++n_small_faces_;
  } else if (corners.size() == 3) {
    add_triangle(corner(0), corner(1), corner(2));
  } else {
    polygons_.push_back(
        {scene_.triangles.size(), polygon_corners_.size(), static_cast<std::uint32_t>(corners.size())});
    for (std::size_t i = 0; i < corners.size(); ++i) polygon_corners_.push_back(corner(i));
    for (std::size_t i = 2; i < corners.size(); ++i) add_triangle(corner(0), corner(i - 1), corner(i));
  }
  return true;
}

bool Mesh::add_strip(std::span<const std::int64_t> corners) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == -1) {
      first = i + 1;
      continue;
    }
    if (!is_vertex(corners[i])) return false;
    if (i < first + 2) continue;
    const bool turned = (i - first) % 2 == 1;
    add_triangle(static_cast<std::uint32_t>(corners[turned ? i - 1 : i - 2]),
                 static_cast<std::uint32_t>(corners[turned ? i - 2 : i - 1]),
                 static_cast<std::uint32_t>(corners[i]));
  }
  return true;
}

void Mesh::cut_polygons() {
  std::vector<dvec3> points;
  for (const Polygon& polygon : polygons_) {
    const std::span<const std::uint32_t> corners(polygon_corners_.data() + polygon.first_corner,
                                                 polygon.n_corners);
    points.clear();
    for (const std::uint32_t c : corners) points.push_back(scene_.vertices[c]);
    Triangle* out = scene_.triangles.data() + polygon.first_triangle;
    bool finished = true;
    const auto cut = triangulate(points, &finished);
    if (!finished) scene_.warnings.push_back(polygon_warning(points.size()));
    for (const auto& pick : cut) {
      out->vertex = {corners[pick[0]], corners[pick[1]], corners[pick[2]]};
      ++out;
    }
  }
}

// Colours are codes of sRGB, as scanners and editors write them.
void Mesh::paint_corners() {
  RawVector<std::array<std::uint32_t, 4>> linear(colors_.size());
  for (std::size_t i = 0; i < colors_.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) linear[i][c] = linear_unit_of_srgb(colors_[i][c] / color_unit_);
    linear[i][3] = linear_unit(colors_[i][3] / color_unit_);
  }
  scene_.paint.colors.resize(scene_.triangles.size());
  for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      set_corner(scene_.paint.colors[i], k, linear[scene_.triangles[i].vertex[k]]);
}

Scene Mesh::finish(const std::string& file) {
  cut_polygons();
  for (std::string& warning : scene_.warnings) warning = file + ": " + warning;
  if (n_small_faces_ > 0) {
    scene_.warnings.push_back(file + ": " + std::to_string(n_small_faces_) +
                              " faces with fewer than 3 corners are left out");
  }
  if (scene_.triangles.empty()) scene_.warnings.push_back(file + ": no faces");
  scene_.materials = {mesh_material()};
  if (!colors_.empty()) {
    Coat coat;
    scene_.materials = {colored_mesh_material(coat)};
    scene_.materials[0].coat = scene_.paint.add(coat);
    paint_corners();
  }
  if (!scene_.normals.empty()) {
    for (Triangle& t : scene_.triangles) t.normal = t.vertex;
    n_shaded_flat_ = settle_normals(scene_, file);
  }
  return std::move(scene_);
}

}  // namespace kdray::scene::ply
