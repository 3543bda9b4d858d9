// What    Scene, geometry and tree -> the arrays of kernels/layout, ready to upload. The sole writer of those structs.
// Shape   Primitive arrays keep Geometry's order, so that references need no translation.
// Errors  ErrorCode::input when the tree has more nodes, references or leaf entries than the 30 bits of the form hold.
#pragma once

#include <vector>

#include "kdtree/tree.h"
#include "layout/primitives.layout.h"
#include "layout/shading.layout.h"
#include "layout/tree.layout.h"
#include "scene/geometry.h"
#include "scene/scene.h"

namespace kdray::flatten {

struct FlatScene {
  std::vector<layout::KdNode> nodes;
  std::vector<layout::u32> refs;
  std::vector<layout::Triangle> triangles;
  std::vector<layout::VertexNormals> normals;
  std::vector<layout::Sphere> spheres;
  std::vector<layout::Cone> cones;
  std::vector<layout::Material> materials;
  std::vector<layout::Light> lights;

  std::size_t bytes() const;
};

FlatScene flatten(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree);

}  // namespace kdray::flatten
