// What    The small scenes that the picture tests share: between them every kind of primitive, material and
//         light.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::test {

// A sphere of rows x 2*rows patches with vertex normals; coarse on purpose, so that shading and geometry
// disagree.
void add_smooth_ball(scene::Scene& scene, const dvec3& center, double radius, int rows,
                     const scene::Material& m);

scene::Scene glass_and_mirror_balls();  // spheres: nested, glass in glass, a mirror; a floor
scene::Scene smooth_meshes();           // vertex normals: matte, glossy, glass, mirror
scene::Scene cones_and_cylinders();     // pointed, truncated, cylinders, glass and mirror ones, seen into
scene::Scene every_kind();              // random ones of each kind: matte, mirrors, glass
scene::Scene every_light();             // point with attenuation, range, directional, spots; emission
scene::Scene flat_glass();              // a slab, a prism with total reflection, index 1, a box of mirrors

scene::Scene textured();     // pictures, colours at corners, holes, veils
scene::Scene mapped();       // mipmaps, and pictures of metal, normals, emission, occlusion and highlights
scene::Scene soft_light();   // lights of each kind that has an area, before a gradient
scene::Scene under_a_sky();  // a picture all around, seen through a lens

// Meshes that are seen many times: smooth and flat ones, with holes, and of shapes; turned, mirrored,
// stretched, large, small, in glass and mirrors, one within another, and one twice in the same place.
scene::Scene instanced();
scene::Scene instanced_maps();  // ... of surfaces with mipmaps and pictures of normals, one of them mirrored

// Moves the primitives of `part` into a new mesh of the scene, with their materials; its number.
std::uint32_t add_mesh(scene::Scene& scene, const scene::Scene& part);
void add_instance(scene::Scene& scene, std::uint32_t mesh, const dmat4& to_world,
                  std::uint32_t material = scene::kNone);

// `model` moved by `offset` and scaled by `scale` about the origin, camera and lights with it.
scene::Scene moved(scene::Scene model, double scale, const dvec3& offset);

struct NamedScene {
  std::string name;
  scene::Scene (*make)();
};
inline void PrintTo(const NamedScene& s, std::ostream* out) {
  *out << s.name;
}
const std::vector<NamedScene>& small_scenes();

}  // namespace kdray::test
