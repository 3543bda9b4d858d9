// What    Reads the materials and the objects of kdray's JSON scenes into a Scene.
// Errors  kdray::Error with the path of the value in the file; a mesh file's own errors name that file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/import/json/json_node.h"
#include "scene/import/materials.h"
#include "scene/import/solids.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// A material: its terms, and the pictures that it names beside the scene. A material with pictures has maps
// in the scene's texturing. Pictures are read once each, as codes of sRGB but for normals. A picture that is
// missing or can't be decoded is an error, since the scene was written with it in mind.
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

// The objects: meshes from files, inline triangles, shapes.
using NamedMaterials = std::map<std::string, Material>;

class JsonObjects {
 public:
  // `folder` is where mesh files are looked for.
  // `unnamed` reads materials that stand within objects.
  JsonObjects(Scene& scene, const NamedMaterials& named, JsonMaterials& unnamed,
              std::filesystem::path folder);

  void read(const JsonNode& object);
  // Called once all are read.
  void finish() {
    settle_solids(unsettled_, scene_);
    scene_.names = names_.finish(scene_.primitive_count(), 0);
  }

 private:
  void read_mesh(const JsonNode& object);
  void read_triangles(const JsonNode& object);
  void read_box(const JsonNode& object);
  void read_cylinder(const JsonNode& object);
  void read_plane(const JsonNode& object);
  template <class Kind>
  void read_shape(Kind, const JsonNode& object);

  Material material_of(const JsonNode& object) const;
  void wear(Scene& part, const Material& material) const;
  void wear_plain(Scene& part, const JsonNode& object);
  const Scene& mesh(const JsonNode& file, bool keeps_texcoords);
  void append(const Scene& part, const JsonNode& object);
  void append_instances(Scene&& part, const JsonNode& object);
  Scene adopted(Scene&& part, const JsonNode& object);
  std::uint32_t add_material(const Material& material, const std::string& name);

  Scene& scene_;
  const NamedMaterials& named_;
  JsonMaterials& unnamed_;
  std::filesystem::path folder_;
  MaterialTable materials_;
  NameTable names_;                                       // of materials
  bool warned_of_pictures_ = false;                       // on shapes
  std::map<std::pair<std::string, bool>, Scene> meshes_;  // a file named by several objects is read once
  Unsettled unsettled_;
  std::uint32_t number_ = 0;  // of the next primitive
};

}  // namespace kdray::scene
