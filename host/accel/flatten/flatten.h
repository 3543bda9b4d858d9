// What    Scene, geometry and tree -> the arrays of kernels/layout, ready to upload. The sole writer of those
//         structs, but for triangles, which the geometry has made and shares with the form.
// Shape   Primitive arrays keep Geometry's order, so that references need no translation. Filled in parallel,
//         in memory that a CPU device uses as it is.
// Errors  ErrorCode::input when the tree has more nodes, references or leaf entries than the 30 bits of the
//         form hold.
#pragma once

#include "accel/kdtree/tree.h"
#include "base/memory.h"
#include "layout/instances.layout.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"
#include "layout/shading.layout.h"
#include "layout/sky.layout.h"
#include "layout/textures.layout.h"
#include "layout/tree.layout.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::flatten {

struct FlatScene {
  Array<layout::KdNode> nodes;
  Array<layout::u32> refs;
  Array<layout::Triangle> triangles;
  Array<layout::VertexNormals> normals;
#define KDRAY_SHAPE_ARRAY(NAME, name, names, Struct) Array<layout::Struct> names;
  KDRAY_SHAPES(KDRAY_SHAPE_ARRAY)
#undef KDRAY_SHAPE_ARRAY
  Array<layout::Instance>
      instances;  // made by prepare/instanced.h, as what is of their meshes in the arrays above
  Array<layout::Material> materials;
  Array<layout::MaterialMaps> material_maps;
  Array<layout::Texture> textures;
  Array<layout::u32> texels;
  Array<layout::TexCoords> texcoords;
  Array<layout::CornerColors> corner_colors;
  Array<layout::Light> lights;
  Array<layout::Sky> sky;  // one, or none
  Array<float> sky_colors;

  std::size_t bytes() const;
};

// Calls visit(array) for each of them, in the order of the members. The struct is taken apart, so that an
// added member can't be forgotten.
template <class Flat, class Visit>
void for_each_flat_array(Flat& flat, const Visit& visit) {
  auto& [nodes, refs, triangles, normals, KDRAY_SHAPES(KDRAY_KIND_PLURAL) instances, materials, material_maps,
         textures, texels, texcoords, corner_colors, lights, sky, sky_colors] = flat;
  const auto visit_all = [&visit](auto&... arrays) { (visit(arrays), ...); };
  visit_all(nodes, refs, triangles, normals, KDRAY_SHAPES(KDRAY_KIND_PLURAL) instances, materials,
            material_maps, textures, texels, texcoords, corner_colors, lights, sky, sky_colors);
}

// The binary form, `nodes` and `refs`, is for the binary walk alone: without it these are empty.
FlatScene flatten(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree,
                  bool binary_form = true);

// Packs the normals of the triangles that have some, in their order; a zero-area triangle has those of its
// neighbour.
Array<layout::VertexNormals> pack_normals(const scene::Scene& scene, const scene::Geometry& geometry);

// Pack what can change without the geometry.
Array<layout::Material> pack_materials(const scene::Scene& scene);
Array<layout::MaterialMaps> pack_material_maps(const scene::Scene& scene);
Array<layout::Light> pack_lights(const scene::Scene& scene, const LocalSpace& space);

}  // namespace kdray::flatten
