// What    The material of meshes whose file names none: a light grey with a soft highlight.
#pragma once

#include "scene/scene.h"

namespace kdray::scene {

inline Material mesh_material() {
  return {.ambient = vec3(0.07f), .diffuse = vec3(0.7f), .specular = vec3(0.2f), .shine = 30};
}

}  // namespace kdray::scene
