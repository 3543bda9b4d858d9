#include "scene/import/gltf/gltf_mesh.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/import/gltf/gltf_accessor.h"
#include "scene/import/gltf/gltf_draco.h"
#include "scene/model/settle_normals.h"
#include "scene/model/smooth_tangents.h"

namespace kdray::scene::gltf {

namespace {

constexpr std::uint64_t kTriangles = 4;  // 5 are strips
constexpr std::uint64_t kFan = 6;
// Instances may make more of a file than is in it, but a small file of nested instances must not fill the
// memory.
constexpr std::size_t kMostOfSmallFile = std::size_t{1} << 22;
constexpr std::size_t kMostPerByte = 16;

// Calls add(a, b, c) for each triangle.
template <class Add>
void for_each_triangle(std::uint64_t mode, std::span<const std::uint32_t> corners, const Add& add) {
  const std::size_t n = corners.size();
  if (mode == kTriangles) {
    for (std::size_t i = 0; i + 3 <= n; i += 3) add(corners[i], corners[i + 1], corners[i + 2]);
    return;
  }
  for (std::size_t i = 0; i + 3 <= n; ++i) {
    if (mode == kFan) {
      add(corners[0], corners[i + 1], corners[i + 2]);
    } else {
      const bool turned = i % 2 == 1;
      add(corners[i], corners[i + (turned ? 2 : 1)], corners[i + (turned ? 1 : 2)]);
    }
  }
}

// The matrix that moves normals: the inverse transpose, up to a positive factor. The cofactors are that even
// where the transform is flat and has no inverse.
dmat3 normal_matrix(const dmat3& m) {
  const dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

}  // namespace

MeshReader::MeshReader(Document& document, Scene& scene)
    : document_(document), scene_(scene), into_(&scene), materials_(document, scene) {}

void MeshReader::add(const JsonNode& mesh, const dmat4& to_world, const Deformation& deformation) {
  for (const JsonNode& primitive : mesh["primitives"].elements())
    add_primitive(primitive, to_world, deformation);
}

Scene MeshReader::alone(const JsonNode& mesh) {
  Scene scene;
  into_ = &scene;
  add(mesh, dmat4(1));
  into_ = &scene_;
  settle(scene);
  scene_.warnings.insert(scene_.warnings.end(), scene.warnings.begin(), scene.warnings.end());
  scene.warnings.clear();
  return scene;
}

std::uint64_t MeshReader::count_triangles(const JsonNode& mesh) {
  std::uint64_t n = 0;
  for (const JsonNode& primitive : mesh["primitives"].elements()) {
    const std::uint64_t mode = whole_or(primitive, "mode", kTriangles);
    const auto indices = primitive.find("indices");
    const auto corners = indices ? indices : primitive["attributes"].find("POSITION");
    if (mode < kTriangles || !corners) continue;
    const std::uint64_t count = accessor_count(document_.entry("accessors", *corners));
    n += mode == kTriangles ? count / 3 : count;
  }
  return n;
}

void MeshReader::check_size(const JsonNode& primitive) const {
  // Buffers beside the file count as soon as they are read.
  const std::size_t most = std::max(kMostOfSmallFile, kMostPerByte * document_.bytes_read());
  if (into_->vertices.size() <= most && into_->triangles.size() <= most && n_primitives_ <= most / 16) return;
  throw primitive.error(
      "the instances of this file make more than " + std::to_string(most) + " triangles of it",
      "split the scene");
}

void MeshReader::add_vertices(const JsonNode& primitive, const VertexMatrices& matrices,
                              const Deformation& deformation) {
  const JsonNode& accessor = document_.entry("accessors", primitive["attributes"]["POSITION"]);
  auto positions = read_vectors(document_, accessor, NotFinite::nan);
  morph(document_, primitive, "POSITION", deformation.weights, positions);
  reserve_more(into_->vertices, positions.size());
  const dmat4 to_world = matrices.of(0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const dmat4 m = matrices.are_all_one() ? to_world : matrices.of(i);
    const dvec3 moved = dvec3(m * glm::dvec4(positions[i], 1));
    if (!is_finite(moved)) {
      if (is_finite(positions[i])) throw accessor.error("a node's transform makes a position infinite");
      if (bad_vertex_.empty()) bad_vertex_ = accessor.place() + ": element " + std::to_string(i);
    }
    into_->vertices.push_back(moved);
  }
}

bool MeshReader::add_normals(const JsonNode& primitive, std::size_t n_vertices,
                             const VertexMatrices& matrices, const Deformation& deformation) {
  const auto index = primitive["attributes"].find("NORMAL");
  if (!index) return false;
  const auto& accessor = document_.entry("accessors", *index);
  if (accessor_count(accessor) != n_vertices) {
    count("primitives have normals that are not as many as their positions: they are left out");
    return false;
  }
  auto normals = read_vectors(document_, accessor, NotFinite::nan);  // those have no direction
  morph(document_, primitive, "NORMAL", deformation.weights, normals);
  const dmat3 to_normal = normal_matrix(dmat3(matrices.of(0)));
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const dmat3 m = matrices.are_all_one() ? to_normal : normal_matrix(dmat3(matrices.of(i)));
    into_->normals.push_back(direction_of(m * normals[i]));
  }
  return true;
}

void MeshReader::add_primitive(const JsonNode& primitive, const dmat4& to_world,
                               const Deformation& deformation) {
  ++n_primitives_;
  check_size(primitive);
  std::uint64_t mode = whole_or(primitive, "mode", kTriangles);
  if (mode > kFan) throw primitive["mode"].expected("a mode from 0 to 6");
  if (mode < kTriangles) return count("primitives of points or lines are left out: they have no surface");
  const JsonNode attributes = primitive["attributes"];
  if (!attributes.find("POSITION")) return count("primitives without positions are left out");

  const DracoMesh packed(document_, primitive);
  if (packed.is_there()) mode = kTriangles;

  const auto first_vertex = static_cast<std::uint32_t>(into_->vertices.size());
  const auto first_normal = static_cast<std::uint32_t>(into_->normals.size());
  const VertexMatrices matrices(document_, primitive, deformation, to_world);
  add_vertices(primitive, matrices, deformation);
  const std::size_t n_vertices = into_->vertices.size() - first_vertex;
  const bool smooth = add_normals(primitive, n_vertices, matrices, deformation);

  RawVector<std::uint32_t> corners;
  if (const auto indices = primitive.find("indices")) {
    corners = read_indices(document_, document_.entry("accessors", *indices), n_vertices);
  } else {
    corners.resize(n_vertices);
    std::iota(corners.begin(), corners.end(), 0u);
  }
  if (mode == kTriangles && corners.size() % 3 != 0) {
    count("primitives have corners after their last whole triangle: they are left out");
  }
  const bool mirrored = glm::determinant(dmat3(matrices.of(0))) < 0;
  const auto colors = colors_of(attributes, n_vertices);
  // By the specification tangents count only where there are normals.
  const std::uint32_t material = materials_.number_of(primitive, {colors.has_value(), smooth});
  std::vector<std::array<std::uint32_t, 3>> picks;
  const std::uint32_t maps = scene_.materials[material].maps;
  const bool textured = maps != kNone;
  reserve_more(into_->triangles, mode == kTriangles ? corners.size() / 3 : corners.size());
  for_each_triangle(mode, corners, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (mirrored) std::swap(b, c);
    Triangle t{.vertex = {first_vertex + a, first_vertex + b, first_vertex + c}};
    if (smooth) t.normal = {first_normal + a, first_normal + b, first_normal + c};
    t.material = material;
    t.number = static_cast<std::uint32_t>(into_->triangles.size());
    into_->triangles.push_back(t);
    if (textured) picks.push_back({a, b, c});
  });
  if (!textured) return;
  add_texcoords(attributes, picks, n_vertices);
  if (colors) add_colors(*colors, picks);
  if (!scene_.texturing.material_maps[maps].tangents) return;
  const auto tangents = tangents_of(attributes, n_vertices);
  if (tangents) return add_tangents(*tangents, primitive, matrices, deformation, picks);
  const Texture& normals = scene_.texturing.textures[scene_.texturing.material_maps[maps].normal_map];
  smooth_tangents(*into_, into_->triangles.size() - picks.size(), normals.set);
}

void MeshReader::finish() {
  materials_.warn();
  for (const auto& [what, n] : counted_) left_out_.insert(std::to_string(n) + " " + what);
  for (const std::string& what : left_out_) scene_.warnings.push_back(document_.file() + ": " + what);
  settle(scene_);
}

void MeshReader::settle(Scene& scene) {
  settle_vertices(scene, [&](std::size_t) { return bad_vertex_; });
  bad_vertex_.clear();
  settle_normals(scene, document_.file());
}

}  // namespace kdray::scene::gltf
