// What    Adds the primitives of a glTF mesh to a scene, moved by a node's transform; a mirroring transform
//         turns the triangles over, so that their front stays where the normals point.
// Shape   Strips and fans become triangles. Points and lines are left out, with a warning.
// Errors  The errors are those of gltf_accessor.h; one more is that instances multiply a small file beyond
//         all measure.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "base/vec.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/gltf/gltf_materials.h"
#include "scene/import/gltf/gltf_pose.h"
#include "scene/model/scene.h"

namespace kdray::scene::gltf {

// Reserves memory for `n` more elements. A bare reserve() would make a file of many small primitives copy all
// of them for each.
template <class Vector>
void reserve_more(Vector& elements, std::size_t n) {
  const std::size_t wanted = elements.size() + n;
  if (wanted > elements.capacity()) elements.reserve(std::max(wanted, 2 * elements.capacity()));
}

class MeshReader {
 public:
  MeshReader(Document& document, Scene& scene, NameTable& names);  // `names` gets those of materials

  void add(const JsonNode& mesh, const dmat4& to_world, const Deformation& deformation = {});
  // Returns the mesh by itself, with the scene's materials.
  Scene alone(const JsonNode& mesh);
  // Returns the number of triangles that add() would add, or a few more.
  std::uint64_t count_triangles(const JsonNode& mesh);
  // Called after the last mesh.
  void finish();
  // Warns once of each kind of thing that is left out, however often it comes.
  void warn(const std::string& what) { left_out_.insert(what); }
  // Warns of it with its number before it: "primitives without positions are left out".
  void count(const std::string& what) { ++counted_[what]; }

 private:
  void add_primitive(const JsonNode& primitive, const dmat4& to_world, const Deformation& deformation);
  void add_vertices(const JsonNode& primitive, const VertexMatrices& matrices,
                    const Deformation& deformation);
  bool add_normals(const JsonNode& primitive, std::size_t n_vertices, const VertexMatrices& matrices,
                   const Deformation& deformation);
  void add_texcoords(const JsonNode& attributes, std::span<const std::array<std::uint32_t, 3>> triangles,
                     std::size_t n_vertices);
  std::optional<RawVector<std::array<double, 4>>> tangents_of(const JsonNode& attributes,
                                                              std::size_t n_vertices);
  void add_tangents(const RawVector<std::array<double, 4>>& values, const JsonNode& primitive,
                    const VertexMatrices& matrices, const Deformation& deformation,
                    std::span<const std::array<std::uint32_t, 3>> triangles);
  void add_colors(const RawVector<std::array<float, 4>>& values,
                  std::span<const std::array<std::uint32_t, 3>> triangles);
  std::optional<RawVector<std::array<float, 4>>> colors_of(const JsonNode& attributes,
                                                           std::size_t n_vertices);
  template <class Elements>
  bool are_good(const Elements& values, const char* what, std::size_t n_vertices);
  void settle(Scene& scene);
  void check_size(const JsonNode& primitive) const;

  Document& document_;
  Scene& scene_;  // that has the materials
  Scene* into_;   // that triangles are added to
  Materials materials_;
  std::size_t n_primitives_ = 0;
  std::string bad_vertex_;  // where the first one stands that is not finite
  std::set<std::string> left_out_;
  std::map<std::string, std::size_t> counted_;
};

}  // namespace kdray::scene::gltf
