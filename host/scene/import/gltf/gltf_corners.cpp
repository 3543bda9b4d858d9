// MeshReader's part that reads what triangles have at their corners beside positions and normals: colours,
// texture coordinates and tangents.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/local_space.h"
#include "scene/import/gltf/gltf_accessor.h"
#include "scene/import/gltf/gltf_mesh.h"
#include "scene/model/tangents.h"

namespace kdray::scene::gltf {

// Whether corners can have them; else they are left out of this primitive.
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

// They move as edges do. What mirrors turns the picture's handedness round.
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
