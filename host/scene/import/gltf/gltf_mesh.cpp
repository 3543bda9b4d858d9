#include "scene/import/gltf/gltf_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/local_space.h"
#include "scene/import/gltf/gltf_accessor.h"
#include "scene/import/gltf/gltf_packed.h"
#include "scene/model/normals.h"
#include "scene/model/tangents.h"

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

// Returns the matrix that moves normals: the inverse transpose, up to a positive factor. The cofactors are
// such a matrix even where the transform is flat and has no inverse.
dmat3 normal_matrix(const dmat3& m) {
  const dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

}  // namespace

MeshReader::MeshReader(Document& document, Scene& scene, NameTable& names)
    : document_(document), scene_(scene), into_(&scene), materials_(document, scene, names) {}

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

// ---- What triangles have at their corners beside positions and normals: colours, texture coordinates and
// tangents

// Returns whether the values can be laid on corners; else they are left out of this primitive.
template <class Elements>
bool MeshReader::are_good(const Elements& values, const char* what, std::size_t n_vertices) {
  const auto finite = [](const auto& element) {
    return std::ranges::all_of(element, [](auto part) { return std::isfinite(part); });
  };
  const bool as_many = values.size() == n_vertices;
  if (as_many && std::ranges::all_of(values, finite)) return true;
  count(std::string("primitives have ") + what + " that are not " +
        (as_many ? "finite" : "as many as their positions") + ": they are left out");
  return false;
}

std::optional<RawVector<std::array<float, 4>>> MeshReader::colors_of(const JsonNode& attributes,
                                                                     std::size_t n_vertices) {
  const auto index = attributes.find("COLOR_0");
  if (!index) return std::nullopt;
  auto values = read_colors(document_, document_.entry("accessors", *index), NotFinite::nan);
  if (!are_good(values, "colours", n_vertices)) return std::nullopt;
  return values;
}

// The triangles, which are the scene's last ones, are named by their vertices within the primitive.
void MeshReader::add_colors(const RawVector<std::array<float, 4>>& values,
                            std::span<const std::array<std::uint32_t, 3>> triangles) {
  auto& colors = into_->texturing.colors;
  reserve_more(colors, into_->triangles.size() - colors.size());
  colors.resize(into_->triangles.size() - triangles.size(), kWhiteCorners);
  for (const auto& corners : triangles) {
    layout::CornerColors c{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& from = values[corners[i]];
      set_corner(c, i,
                 {linear_unit(from[0]), linear_unit(from[1]), linear_unit(from[2]), linear_unit(from[3])});
    }
    colors.push_back(c);
  }
}

void MeshReader::add_texcoords(const JsonNode& attributes,
                               std::span<const std::array<std::uint32_t, 3>> triangles,
                               std::size_t n_vertices) {
  for (std::size_t set = 0; set < 2; ++set) {
    const auto index = attributes.find("TEXCOORD_" + std::to_string(set));
    if (!index) continue;
    const auto values = read_pairs(document_, document_.entry("accessors", *index), NotFinite::nan);
    if (!are_good(values, "texture coordinates", n_vertices)) continue;
    auto& out = into_->texturing.texcoords[set];
    reserve_more(out, into_->triangles.size() - out.size());
    out.resize(into_->triangles.size() - triangles.size());
    for (const auto& corners : triangles) {
      layout::TexCoords at{};
      for (std::size_t i = 0; i < 3; ++i)
        at.uv[i][0] = values[corners[i]][0], at.uv[i][1] = values[corners[i]][1];
      out.push_back(at);
    }
  }
}

std::optional<RawVector<std::array<double, 4>>> MeshReader::tangents_of(const JsonNode& attributes,
                                                                        std::size_t n_vertices) {
  const auto index = attributes.find("TANGENT");
  if (!index) return std::nullopt;
  auto values = read_quads(document_, document_.entry("accessors", *index), NotFinite::nan);
  if (!are_good(values, "tangents", n_vertices)) return std::nullopt;
  return values;
}

// Tangents move as edges do. A mirroring transform changes the picture's handedness.
void MeshReader::add_tangents(const RawVector<std::array<double, 4>>& values, const JsonNode& primitive,
                              const VertexMatrices& matrices, const Deformation& deformation,
                              std::span<const std::array<std::uint32_t, 3>> triangles) {
  RawVector<dvec3> ways(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) ways[i] = {values[i][0], values[i][1], values[i][2]};
  morph(document_, primitive, "TANGENT", deformation.weights, ways);
  std::vector<std::array<float, 2>> packed(ways.size());
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const dmat3 m(matrices.of(i));
    const double side = glm::determinant(m) < 0 ? -1 : 1;
    packed[i] = packed_tangent({safe_normalize(m * ways[i]), values[i][3] < 0 ? -side : side});
  }
  auto& out = into_->texturing.tangents;
  reserve_more(out, into_->triangles.size() - out.size());
  out.resize(into_->triangles.size() - triangles.size());
  for (const auto& corners : triangles) {
    layout::TexCoords at{};
    for (std::size_t i = 0; i < 3; ++i) std::ranges::copy(packed[corners[i]], at.uv[i]);
    out.push_back(at);
  }
}

}  // namespace kdray::scene::gltf
