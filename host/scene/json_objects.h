// What    Reads the "objects" of a JSON scene (meshes from files, inline triangles, shapes) into a
//         Scene.
// Errors  kdray::Error with the object's path; a mesh file's own errors name that file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/json_node.h"
#include "scene/material_table.h"
#include "scene/scene.h"

namespace kdray::scene {

using NamedMaterials = std::map<std::string, Material>;

Material read_material(const JsonNode& node);

class JsonObjects {
 public:
  // `folder` is where mesh files are looked for.
  JsonObjects(Scene& scene, const NamedMaterials& named, std::filesystem::path folder);

  void read(const JsonNode& object);

 private:
  void read_mesh(const JsonNode& object);
  void read_triangles(const JsonNode& object);
  template <class Kind>
  void read_shape(Kind, const JsonNode& object);

  Material material_of(const JsonNode& object) const;
  const Scene& mesh(const JsonNode& file);
  void append(const Scene& part, const JsonNode& object);
  void append_instances(Scene&& part, const JsonNode& list);
  Scene adopted(Scene&& part);

  Scene& scene_;
  const NamedMaterials& named_;
  std::filesystem::path folder_;
  MaterialTable materials_;
  std::map<std::string, Scene> meshes_;  // a file named by several objects is read once
  std::uint32_t number_ = 0;             // of the next primitive
};

}  // namespace kdray::scene
