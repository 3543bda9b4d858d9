// What    Prepares a scene's meshes, each like a scene of its own, and joins them and a tree over their
//         instances to the scene: primitives, blocks and nodes behind the scene's own, and a root above both
//         trees.
// Why     Memory grows with what is unique: an instance takes 128 bytes, and a share of a node.
#pragma once

#include <optional>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/prepare/prepared.h"

namespace kdray::prepare {

class Meshes {
 public:
  Meshes(const scene::Scene& scene, const kdtree::BuildConfig& config);

  // Returns the size of blocks for all trees: the one that suits the largest.
  int block(const kdtree::Tree& tree, std::size_t n_primitives) const;

  // Joins the meshes to `made`, which has the scene's own primitives and tree, with blocks of that size.
  void join(Prepared& made) const;

 private:
  struct Mesh {
    scene::Geometry geometry;
    kdtree::Tree tree;
  };

  const scene::Scene& scene_;
  std::vector<Mesh> meshes_;
};

// Returns `last` with its instances where they are in `scene`, of which nothing else has changed but lights,
// sky and view: trees of meshes, and of what is no instance, are kept, the tree over instances is built anew.
// The result is bit for bit what preparing anew in the same space would give. Returns nothing where the scene
// has to be prepared anew: where it doesn't keep its space, or its materials have changed.
std::optional<Prepared> replace_instances(const scene::Scene& scene, const Prepared& last);

// Returns the number of primitives of the largest mesh.
std::size_t largest_mesh(const scene::Scene& scene);

// Throws ErrorCode::usage where a prepared scene has instances, which `what` doesn't support.
void refuse_instances(const Prepared& scene, const char* what);

}  // namespace kdray::prepare
