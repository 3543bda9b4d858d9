// What    The materials of an OBJ file: numbers for the names that `usemtl` gives, and at the end what the
//         MTL files say about them.
// Errors  A missing MTL file, or a missing material, is a warning and the default material.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scene/import/obj/mtl.h"
#include "scene/model/scene.h"

namespace kdray::scene {

class ObjMaterials {
 public:
  // `scene` gets the materials and warnings; `file` is the OBJ file, beside which MTL files are looked for.
  ObjMaterials(const std::filesystem::path& file, Scene& scene) : file_(file), scene_(scene) {}

  void add_library(std::string_view names, std::uint32_t line);
  void use(std::string_view name);
  std::uint32_t current();  // the material of the faces that follow
  // Called after the last line. `colored` says whether vertices have colours; `names` gets the materials'.
  void finish(bool colored, NameTable& names);

 private:
  std::filesystem::path find(const std::string& name) const;
  std::filesystem::path find_last_part(const std::string& name) const;
  bool read_library(const std::filesystem::path& path);
  Material material_of(const MtlMaterial* mtl, bool colored);
  void add_maps(const MtlMaterial& mtl, Material& m, MaterialMaps& maps);
  std::optional<std::uint32_t> normals_of(const MtlMaterial& mtl);
  std::optional<std::uint32_t> veiled(const MtlMaterial& mtl, MaterialMaps& maps);
  std::optional<std::uint32_t> texture_of(const MtlPicture& map, bool curved);
  std::uint32_t add_texture(std::uint32_t picture, const MtlPicture& map, bool curved);
  std::optional<std::uint32_t> picture_of(const std::string& name);

  std::filesystem::path file_;
  Scene& scene_;
  std::vector<MtlMaterial> library_;
  std::vector<std::string> names_;  // by material number
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<std::filesystem::path> read_files_;
  std::uint32_t current_ = kNone;
  std::unordered_map<std::string, std::optional<std::uint32_t>> pictures_;  // by the name in the file
};

}  // namespace kdray::scene
