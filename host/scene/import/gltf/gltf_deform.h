// What    Morph targets and skins: what they make of a primitive's positions and normals.
// Shape   Morph targets come first, in the mesh's own space. A skin then moves each vertex by the mean of its
//         joints' matrices, weighted; the node's own place doesn't count. Sets of four joints, as many as
//         there are up to kMostJointSets.
// Errors  kdray::Error with the path: targets, joints and weights that are not as many as the positions,
//         joints that the skin doesn't have.
// Source  Khronos Group, "glTF 2.0 Specification", 2021, 3.7.2.2 and 3.7.3.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "base/memory.h"
#include "base/vec.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/import/gltf/gltf_pose.h"

namespace kdray::scene::gltf {

inline constexpr std::size_t kMostJointSets = 8;

// What happens to a mesh where a node shows it.
struct Deformation {
  std::vector<double> weights = {};                       // of morph targets; empty: of none
  std::shared_ptr<const std::vector<dmat4>> joints = {};  // from where they were bound; none: no skin

  bool any() const { return !weights.empty() || joints; }
};

class Deformations {
 public:
  Deformations(Document& document, Pose& pose) : document_(document), pose_(pose) {}

  Deformation of(const JsonNode& node, const JsonNode& mesh);

 private:
  std::shared_ptr<const std::vector<dmat4>> joints_of(const JsonNode& skin);

  Document& document_;
  Pose& pose_;
  std::map<const void*, std::shared_ptr<const std::vector<dmat4>>> skins_;  // by their ids
};

// The matrices by which a primitive's vertices go to the file's space.
class VertexMatrices {
 public:
  // `to_world` is that of the node, for all vertices where there is no skin.
  VertexMatrices(Document& document, const JsonNode& primitive, const Deformation& deformation,
                 const dmat4& to_world);

  dmat4 of(std::size_t vertex) const;
  bool are_all_one() const { return sets_.empty(); }

 private:
  struct Set {
    RawVector<std::array<double, 4>> joints, weights;
  };

  dmat4 to_world_;
  std::shared_ptr<const std::vector<dmat4>> joints_;
  std::vector<Set> sets_;
};

// Adds the primitive's morph targets of this attribute, weighted, to its values.
void morph(Document& document, const JsonNode& primitive, std::string_view attribute,
           std::span<const double> weights, RawVector<dvec3>& values);

}  // namespace kdray::scene::gltf
