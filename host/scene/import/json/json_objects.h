// What    Reads the "objects" of a JSON scene (meshes from files, inline triangles, shapes) into a
//         Scene.
// Errors  kdray::Error with the object's path; a mesh file's own errors name that file.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/import/json/json_material.h"
#include "scene/import/json/json_node.h"
#include "scene/import/material_table.h"
#include "scene/import/solids.h"
#include "scene/model/scene.h"

namespace kdray::scene {

using NamedMaterials = std::map<std::string, Material>;

class JsonObjects {
 public:
  // `folder` is where mesh files are looked for.
  // `unnamed` reads materials that stand within objects.
  JsonObjects(Scene& scene, const NamedMaterials& named, JsonMaterials& unnamed,
              std::filesystem::path folder);

  void read(const JsonNode& object);
  // Once all are read.
  void finish() { settle_solids(unsettled_, scene_); }

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
  const Scene& mesh(const JsonNode& file);
  void append(const Scene& part, const JsonNode& object);
  void append_instances(Scene&& part, const JsonNode& list);
  Scene adopted(Scene&& part);

  Scene& scene_;
  const NamedMaterials& named_;
  JsonMaterials& unnamed_;
  std::filesystem::path folder_;
  MaterialTable materials_;
  std::map<std::string, Scene> meshes_;  // a file named by several objects is read once
  Unsettled unsettled_;
  std::uint32_t number_ = 0;  // of the next primitive
};

}  // namespace kdray::scene
