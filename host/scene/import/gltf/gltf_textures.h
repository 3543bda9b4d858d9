// What    The textures of a glTF file that materials ask for: pictures decoded once each, samplers, sets of
//         coordinates, KHR_texture_transform.
// Errors  None: what is missing, damaged, of another format or wrong in the file costs the picture, with a
//         warning. The material's factors hold then.
// Source  glTF 2.0, 3.8; KHR_texture_transform.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "scene/import/gltf/gltf_document.h"
#include "scene/model/scene.h"

namespace kdray::scene::gltf {

class Textures {
 public:
  Textures(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  // The number among the scene's textures of what a material's texture info names; `curved`: its colours are
  // codes of sRGB.
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

}  // namespace kdray::scene::gltf
