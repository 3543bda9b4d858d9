// What    A geometry that a program adds to a scene: its arrays, checked and copied (kdray/model.h has what
//         they are made of).
// Shape   A geometry holds primitives of one kind, whose order is the program's. Indices are into its own
//         vertices and normals; materials and numbers are given when scenes are made of geometries
//         (assemble()). What a tree is built of, all primitives of a scene in float, is scene::Geometry.
// Errors  kdray::Error, ErrorCode::input: names the array and the element: "vertices[12]: not finite".
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/memory.h"
#include "kdray/model.h"
#include "scene/model/scene.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

struct AddedGeometry {
  std::string name;
  std::uint32_t mask = 0xffffffffu;
  std::uint32_t material = 0;
  bool enabled = true;
  bool prototype = false;  // seen by its instances alone
  GeometryId of = kNone;   // instances: their prototype
  RawVector<dvec3> vertices;
  RawVector<vec3> normals;
  PageVector<Triangle> triangles;
  PageVector<layout::TexCoords> texcoords;  // of the triangles; or none
#define KDRAY_SHAPE_ARRAY(NAME, name, names, Struct) std::vector<Struct> names;
  KDRAY_SHAPES(KDRAY_SHAPE_ARRAY)
#undef KDRAY_SHAPE_ARRAY
  PageVector<Instance> instances;  // their meshes are given as materials are

  bool is_instances() const {
    return of != kNone;
  }
  std::uint32_t primitive_count() const {
    return static_cast<std::uint32_t>(primitives::count_primitives(*this));
  }
};

AddedGeometry make_added(const Mesh& mesh);
AddedGeometry make_added(const Shapes& shapes);

// Moves the vertices of a mesh: `vertices` are as many as it has, `normals` as in Mesh. Leaves `geometry` as
// it was when it throws. ErrorCode::usage where the geometry is no mesh.
void move_vertices(AddedGeometry& geometry, const Points& vertices, const Points& normals);

Material material_of(const kdray::Material& m);
Light light_of(const kdray::Light& l);
Sky sky_of(const kdray::Gradient& gradient);
Sky sky_of(const kdray::Environment& environment, std::vector<std::string>& warnings);  // reads its file
Camera camera_of(const kdray::Camera& c);
vec3 color_of(const Color& c, const char* name);

// Returns the geometry as a mesh that instances can be of; its materials' numbers begin at `first_material`.
Scene mesh_of(const AddedGeometry& geometry, std::uint32_t first_material);

// Puts the enabled geometries behind what `scene` has: primitives are numbered in a row, one geometry after
// the other, after those that are there. The geometries' material numbers are places in `materials`; where
// that is empty they all have the default material.
void assemble(Scene& scene, std::span<const AddedGeometry* const> geometries,
              std::span<const Material> materials);

// Does the same where only vertices and normals of the geometries have changed since `before` was assembled
// of them: `scene` has no primitives, and takes over those of `before`.
void assemble_moved(Scene& scene, Scene&& before, std::span<const AddedGeometry* const> geometries,
                    std::span<const Material> materials);

// ---- Instances: transforms of one prototype, checked and copied; all of them are one geometry.

AddedGeometry make_added(GeometryId prototype, const Transforms& transforms, const Words& materials,
                         std::size_t n_materials);

// Moves the instances; there are as many transforms as instances. Leaves them as they were when it throws:
// ErrorCode::usage where the geometry has no instances.
void move_instances(AddedGeometry& geometry, const Transforms& transforms);

// Adds them to the scene's instances, as instances of its mesh of that number.
void put_instances(Scene& scene, const AddedGeometry& geometry, std::uint32_t mesh,
                   std::uint32_t first_material);

// ---- Pictures on meshes: a program's pixels or files as pictures, its materials with their maps, and how
// both come to an assembled scene.

std::shared_ptr<const Picture> picture_of(const Pixels& pixels);
std::shared_ptr<const Picture> picture_of(const std::filesystem::path& file,
                                          std::vector<std::string>& warnings);

// Returns the material in Whitted's terms; one with pictures gets maps in `texturing`, into whose pictures
// its numbers are.
Material textured_material(const kdray::Material& material, Texturing& texturing);

// Adds that texturing, and the meshes' coordinates, to a scene to which `geometries` and its last
// `n_materials` materials were just added.
void assemble_textures(Scene& scene, std::span<const AddedGeometry* const> geometries,
                       const Texturing& texturing, std::size_t n_materials);

}  // namespace kdray::scene
