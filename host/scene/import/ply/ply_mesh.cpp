#include "scene/import/ply/ply_mesh.h"

#include <algorithm>
#include <cmath>

#include "scene/import/materials.h"
#include "scene/model/normals.h"
#include "scene/model/polygon.h"

namespace kdray::scene::ply {

bool Mesh::add_face(std::span<const std::int64_t> corners, std::span<const TexCoord> texcoords) {
  if (!std::ranges::all_of(corners, [&](std::int64_t c) { return is_vertex(c); })) return false;
  const auto corner = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  const std::size_t first = scene_.triangles.size();
  if (corners.size() < 3) {
    ++n_small_faces_;
  } else if (corners.size() == 3) {
    add_triangle(corner(0), corner(1), corner(2));
    if (!texcoords.empty()) set_texcoords(first, texcoords, {0, 1, 2});
  } else {
    polygons_.push_back({first, polygon_corners_.size(), static_cast<std::uint32_t>(corners.size())});
    for (std::size_t i = 0; i < corners.size(); ++i) polygon_corners_.push_back(corner(i));
    for (std::size_t i = 2; i < corners.size(); ++i) add_triangle(corner(0), corner(i - 1), corner(i));
    if (!texcoords.empty()) {
      polygon_texcoords_.resize(polygons_.back().first_corner);  // those of earlier ones that had none
      polygon_texcoords_.insert(polygon_texcoords_.end(), texcoords.begin(), texcoords.end());
    }
  }
  return true;
}

// In textures v goes downwards.
void Mesh::set_texcoords(std::size_t triangle, std::span<const TexCoord> of,
                         const std::array<std::uint32_t, 3>& pick) {
  auto& all = scene_.texturing.texcoords[0];
  if (all.size() <= triangle) all.resize(triangle + 1);
  for (std::size_t k = 0; k < 3; ++k) {
    const double u = of[pick[k]][0], v = of[pick[k]][1];
    const bool good = std::isfinite(u) && std::isfinite(v);
    n_bad_texcoords_ += !good;
    constexpr double kMost = 1e6;
    all[triangle].uv[k][0] = good ? static_cast<float>(std::clamp(u, -kMost, kMost)) : 0;
    all[triangle].uv[k][1] = good ? static_cast<float>(std::clamp(1 - v, -kMost, kMost)) : 0;
  }
}

void Mesh::color_face(std::size_t first, const VertexColor& color) {
  const LinearColor of_face = linear(color);
  scene_.texturing.colors.resize(scene_.triangles.size(), kWhiteCorners);
  for (std::size_t i = first; i < scene_.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) set_corner(scene_.texturing.colors[i], k, of_face);
}

void Mesh::set_texture(std::size_t first, std::uint32_t texture) {
  for (std::size_t i = first; i < scene_.triangles.size(); ++i) scene_.triangles[i].material = texture;
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
      if (polygon.first_corner < polygon_texcoords_.size())
        set_texcoords(static_cast<std::size_t>(out - scene_.triangles.data()),
                      std::span(polygon_texcoords_).subspan(polygon.first_corner, corners.size()), pick);
      ++out;
    }
  }
}

// Colours are codes of sRGB, as scanners and editors write them.
Mesh::LinearColor Mesh::linear(const VertexColor& color) {
  LinearColor out;
  for (std::size_t c = 0; c < 3; ++c) out[c] = linear_unit_of_srgb(color[c] / color_unit_);
  out[3] = linear_unit(color[3] / color_unit_);
  n_bad_colors_ += !std::ranges::all_of(color, [](float part) { return std::isfinite(part); });
  return out;
}

void Mesh::color_corners() {
  RawVector<LinearColor> of_vertex(vertices_.colors.size());
  for (std::size_t i = 0; i < of_vertex.size(); ++i) of_vertex[i] = linear(vertices_.colors[i]);
  scene_.texturing.colors.resize(scene_.triangles.size());
  for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      set_corner(scene_.texturing.colors[i], k, of_vertex[scene_.triangles[i].vertex[k]]);
}

void Mesh::lay_corners() {
  for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
    set_texcoords(i, vertices_.texcoords, scene_.triangles[i].vertex);
}

Scene Mesh::finish(const std::string& file) {
  scene_.vertices = std::move(vertices_.places);
  scene_.normals = std::move(vertices_.normals);
  cut_polygons();
  if (!vertices_.texcoords.empty()) lay_corners();
  if (!vertices_.colors.empty()) color_corners();
  const auto warn_of = [&](std::size_t n, const char* what) {
    if (n > 0) warn(std::to_string(n) + " " + what);
  };
  warn_of(n_small_faces_, "faces with fewer than 3 corners are left out");
  warn_of(n_bad_colors_, "colours are not finite: what is not is taken for 0");
  warn_of(n_bad_texcoords_, "texture coordinates are not finite: they are taken for 0");
  for (std::string& warning : scene_.warnings) warning = file + ": " + warning;
  scene_.materials = {mesh_material()};
  if (!scene_.texturing.colors.empty() || !vertices_.colors.empty()) {
    MaterialMaps maps;
    scene_.materials = {colored_mesh_material(maps)};
    scene_.materials[0].maps = scene_.texturing.add(maps);
  }
  settle_vertices(scene_, [&](std::size_t i) { return file + ": element 'vertex' " + std::to_string(i); });
  if (!scene_.normals.empty()) {
    for (Triangle& t : scene_.triangles) t.normal = t.vertex;
    n_shaded_flat_ = settle_normals(scene_, file);
  }
  return std::move(scene_);
}

}  // namespace kdray::scene::ply
