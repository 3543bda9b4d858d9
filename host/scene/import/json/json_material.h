// What    A material of kdray's JSON: its terms, and the pictures that it names beside the scene.
// Shape   A material with pictures has maps in the scene's texturing. Pictures are read once each, as codes
//         of sRGB but for normals.
// Errors  kdray::Error with the path in the file: what is wrong in it, and a picture that is missing or can't
//         be decoded, since the scene was written with it in mind.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/import/json/json_node.h"
#include "scene/model/scene.h"

namespace kdray::scene {

class JsonMaterials {
 public:
  // `folder` is where pictures are looked for; `scene` gets their textures.
  JsonMaterials(Scene& scene, std::filesystem::path folder) : scene_(scene), folder_(std::move(folder)) {}

  Material read(const JsonNode& node);

 private:
  std::uint32_t texture_of(const JsonNode& material, std::string_view key, bool curved);
  std::uint32_t picture_of(const JsonNode& file);

  Scene& scene_;
  std::filesystem::path folder_;
  std::map<std::string, std::uint32_t> pictures_;  // by the name in the file
};

}  // namespace kdray::scene
