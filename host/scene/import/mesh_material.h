// What    The material of meshes whose file names none: a light grey with a soft highlight.
#pragma once

#include "scene/model/scene.h"

namespace kdray::scene {

inline Material mesh_material() {
  return {.ambient = vec3(0.07f), .diffuse = vec3(0.7f), .specular = vec3(0.2f), .shine = 30};
}

// The same where colours at corners say what colour it is. `maps` gets what they multiply.
inline Material colored_mesh_material(MaterialMaps& maps) {
  maps = {.ambient = vec3(0.1f), .diffuse = vec3(1), .colored = 1};
  return {.specular = vec3(0.2f), .shine = 30};
}

}  // namespace kdray::scene
