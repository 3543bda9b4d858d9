// What    Prepares a scene's meshes, each like a scene of its own, and joins them and a tree over their
//         instances to the scene: primitives, blocks and nodes behind the scene's own, and a root above both
//         trees.
// Why     Memory grows with what is unique: an instance takes 128 bytes, and a share of a node.
#pragma once

#include <vector>

#include "kdtree/build.h"
#include "prepare/prepared.h"

namespace kdray::prepare {

class Meshes {
 public:
  Meshes(const scene::Scene& scene, const kdtree::BuildConfig& config);

  // The size of blocks for all trees: that of the largest.
  int block(const kdtree::Tree& tree, std::size_t n_primitives) const;

  // `made` has the scene's own primitives and tree, with blocks of that size.
  void join(Prepared& made) const;

 private:
  struct Mesh {
    scene::Geometry geometry;
    kdtree::Tree tree;
  };

  const scene::Scene& scene_;
  std::vector<Mesh> meshes_;
};

// The primitives of the largest mesh.
std::size_t largest_mesh(const scene::Scene& scene);

// Throws ErrorCode::usage where a prepared scene has instances, which `what` doesn't know.
void refuse_instances(const Prepared& scene, const char* what);

}  // namespace kdray::prepare
