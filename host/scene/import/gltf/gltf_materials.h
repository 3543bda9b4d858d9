// What    glTF materials in the terms of the Whitted model, with their textures, and their numbers in the
//         scene. docs/scenes-meshes.md tells users how they are mapped.
// Source  glTF 2.0, 3.8 and appendix B (the metallic-roughness model); KHR_texture_transform,
//         KHR_materials_ior, _transmission, _volume, _emissive_strength, _unlit, _pbrSpecularGlossiness.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/import/gltf/gltf_document.h"
#include "scene/model/scene.h"

namespace kdray::scene::gltf {

// The textures that materials ask for: pictures decoded once each, samplers, sets of coordinates,
// KHR_texture_transform. What is missing, damaged, of another format or wrong in the file costs the picture,
// with a warning. The material's factors hold then.
class Textures {
 public:
  Textures(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // Returns the number among the scene's textures of what a material's texture info names; `curved`: its
  // colours are codes of sRGB.
  std::optional<std::uint32_t> number_of(const JsonNode& info, bool curved);

 private:
  std::optional<std::uint32_t> picture_of(const JsonNode& texture);
  std::optional<std::uint32_t> read(const JsonNode& info, bool curved);
  std::uint32_t decode(const JsonNode& image, std::uint64_t number);
  void read_sampler(const JsonNode& texture, Texture& out);

  Document& document_;
  Scene& scene_;
  std::map<std::uint64_t, std::optional<std::uint32_t>> pictures_;  // by the image's number
};

class Materials {
 public:
  Materials(Document& document, Scene& scene, NameTable& names)
      : document_(document), scene_(scene), names_(names), textures_(document, scene) {}

  // The scene's number of the material that a primitive names, or of glTF's default material. `at`: what
  // the primitive has at its corners; tangents count where a picture bends normals.
  struct Corners {
    bool colors = false, tangents = false;
    auto operator<=>(const Corners&) const = default;
  };
  std::uint32_t number_of(const JsonNode& primitive, Corners at);
  // Called after the last primitive: warns of what was left out.
  void warn();

 private:
  Material read(const JsonNode* node, Corners at);
  std::optional<std::uint32_t> base_texture(const JsonNode& node);
  std::uint32_t map_of(const JsonNode& holder, std::string_view key, bool curved);
  void read_maps(const JsonNode& node, bool has_metal, MaterialMaps& maps, vec3& emission);
  void count_left_out(const JsonNode& node);

  Document& document_;
  Scene& scene_;
  NameTable& names_;
  Textures textures_;
  // By the file's index, kDefault for no material, and what its corners have.
  std::map<std::pair<std::uint64_t, Corners>, std::uint32_t> numbers_;
  std::map<std::string, std::size_t> left_out_;  // number of materials by what they ask for in vain
};

}  // namespace kdray::scene::gltf
