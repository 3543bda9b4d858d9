// What    The materials of an MTL file, as the file says them, and in the terms of the Whitted model.
// Errors  kdray::Error for UTF-16 alone. What is no finite number where one is wanted leaves the default,
//         what is out of range (a negative colour) is brought into range; unknown statements are left out, as
//         every exporter has its own: one warning of each kind.
// Source  Alias Wavefront, "MTL material format", Appendix B2 of the Advanced Visualizer manual.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/vec.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// A picture and its options. It is looked at u*scale[0] + offset[0], and v likewise, where v goes upwards.
struct MtlPicture {
  std::string file;
  std::array<double, 2> scale{1, 1}, offset{0, 0};
  bool clamp = false;
  double strength = 1;  // of a relief
};

struct MtlMaterial {
  std::string name;
  vec3 kd{0.8f}, ks{0}, ke{0};
  std::optional<vec3> tf;         // colour that is let through
  std::optional<float> dissolve;  // `d`: 1 is opaque
  std::optional<float> tr;        // 1 - d, as some exporters write it; `d` wins
  float ns = 0, ni = 1;
  std::optional<int> illum;
  std::optional<MtlPicture> map_kd, map_ks, map_ke, map_d;
  std::optional<MtlPicture> normals, relief;  // `norm`; `bump` and `map_Bump`, which may show normals as well
  std::vector<std::string> left_out;          // statements that nothing is made of
};

// Adds the file's materials to `materials`, its warnings to `warnings`.
void read_mtl(std::string_view text, const std::string& file, std::vector<MtlMaterial>& materials,
              std::vector<std::string>& warnings);

// Returns the material in the terms of the Whitted model; docs/scenes-meshes.md has the table for users.
// `has_picture` says whether the picture of map_Kd is there.
Material whitted_from_mtl(const MtlMaterial& mtl, bool has_picture = false);

// Returns whether nothing is seen of a surface but a highlight.
bool is_invisible(const MtlMaterial& mtl);

// The materials of an OBJ file: numbers for the names that `usemtl` gives, and at the end what the MTL
// files say about them. Errors: A missing MTL file, or a missing material, is a warning and the default
// material.
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
