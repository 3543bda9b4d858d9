// What    Materials of files: MaterialTable gives equal ones one number, so that a file that repeats its
//         materials (one `f` line per ball) costs the device one entry; mesh_material() is that of meshes
//         whose file names none.
// Shape   Numbers index the vector the table was made over; entries already in it are found too.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

struct MaterialHash {
  std::size_t operator()(const Material& m) const;
};

class MaterialTable {
 public:
  explicit MaterialTable(std::vector<Material>& materials);

  // Returns the number of a material equal to `m`, adding it when there is none.
  std::uint32_t add(const Material& m);

 private:
  std::vector<Material>& materials_;
  std::unordered_map<Material, std::uint32_t, MaterialHash> numbers_;
};

// Returns the material of meshes whose file names none: a light grey with a soft highlight.
inline Material mesh_material() {
  return {.ambient = vec3(0.07f), .diffuse = vec3(0.7f), .specular = vec3(0.2f), .shine = 30};
}

// Returns the material of such meshes that have colours at their corners. `maps` gets what these multiply.
inline Material colored_mesh_material(MaterialMaps& maps) {
  maps = {.ambient = vec3(0.1f), .diffuse = vec3(1), .colored = 1};
  return {.specular = vec3(0.2f), .shine = 30};
}

}  // namespace kdray::scene
