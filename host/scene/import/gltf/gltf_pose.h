// What    Where the nodes of a glTF file are, and how far their meshes are morphed: at rest, as the file has
//         them, or at a second of its animation.
// Errors  kdray::Error with a sampler's path, for values that are not as many as the keyframes want; those of
//         gltf_accessor.h; ErrorCode::usage for an animation that the file doesn't have. A channel that moves
//         something else than nodes is left out, with a warning.
// Source  Khronos Group, "glTF 2.0 Specification", 2021, 3.5 and 3.11.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/memory.h"
#include "base/vec.h"
#include "kdray/options.h"
#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

class Pose {
 public:
  Pose(Document& document, const LoadOptions& options);

  // Returns a node's transform to its parent's space, and to the file's.
  dmat4 local(const JsonNode& node) const;
  dmat4 to_world(const JsonNode& node_index);
  // Returns the weights of a mesh's morph targets where this node shows it; empty where none has one.
  std::vector<double> weights(const JsonNode& node, const JsonNode& mesh) const;

  // Returns what the file has and this leaves out, or what was asked for in vain.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Moved {
    std::optional<dvec3> translation, scale;
    std::optional<glm::dquat> rotation;
    std::optional<std::vector<double>> weights;
  };

  std::vector<JsonNode> chosen(const LoadOptions& options);
  void play(const JsonNode& animation, double time);
  void play(const JsonNode& channel, const JsonNode& sampler, double time);
  void find_parents();

  Document& document_;
  std::map<const void*, Moved> moved_;  // by the nodes' ids
  std::vector<std::size_t> parents_;    // of all nodes, once they are asked for
  std::map<std::uint64_t, dmat4> worlds_;
  std::vector<std::string> warnings_;
  std::size_t n_left_out_ = 0;  // channels
};

// Returns how many morph targets the mesh has.
std::size_t target_count(const JsonNode& mesh);

// Morph targets and skins: what they make of a primitive's positions and normals. Morph targets come first,
// in the mesh's own space. A skin then moves each vertex by the mean of its joints' matrices, weighted; the
// node's own place doesn't count. Sets of four joints, as many as there are up to kMostJointSets. Errors:
// kdray::Error with the path: targets, joints and weights that are not as many as the positions, joints
// that the skin doesn't have. Source: Khronos Group, "glTF 2.0 Specification", 2021, 3.7.2.2 and 3.7.3.
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
