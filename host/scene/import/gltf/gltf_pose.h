// What    Where the nodes of a glTF file are, and how far their meshes are morphed: at rest, as the file has
//         them, or at a second of its animation.
// Errors  kdray::Error with a sampler's path, for values that are not as many as the keyframes want; those of
//         gltf_accessor.h; ErrorCode::usage for an animation that the file doesn't have. A channel that moves
//         something else than nodes is left out, with a warning.
// Source  Khronos Group, "glTF 2.0 Specification", 2021, 3.5 and 3.11.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace kdray::scene::gltf
