// What    glTF materials in the terms of the Whitted model, and their numbers in the scene.
//         docs/scenes-meshes.md tells users how they are mapped.
// Source  glTF 2.0, appendix B (the metallic-roughness model); KHR_materials_ior, _transmission, _volume,
//         _emissive_strength, _unlit, _pbrSpecularGlossiness.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace kdray::scene::gltf {

class Materials {
 public:
  Materials(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // The scene's number of the material that a primitive names, or of glTF's default material.
  std::uint32_t number_of(const JsonNode& primitive);
  // Called after the last primitive: warns of what was left out.
  void warn();

 private:
  Material read(const JsonNode& node);
  void count_left_out(const JsonNode& node);

  Document& document_;
  Scene& scene_;
  std::map<std::uint64_t, std::uint32_t> numbers_;  // by the file's index; kDefault for no material
  bool any_picture_ = false;
  std::map<std::string, std::size_t> left_out_;  // number of materials by what they ask for in vain
};

}  // namespace kdray::scene::gltf
