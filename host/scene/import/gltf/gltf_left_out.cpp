#include "scene/import/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scene/import/text_scanner.h"

namespace kdray::scene::gltf {

namespace {

using nlohmann::json;

// Returns whether an extension is read, is reported elsewhere, or has no effect on pictures.
bool is_known(std::string_view name) {
  constexpr std::array<std::string_view, 27> kKnown = {"EXT_mesh_gpu_instancing",
                                                       "EXT_meshopt_compression",
                                                       "EXT_texture_avif",
                                                       "EXT_texture_webp",
                                                       "KHR_draco_mesh_compression",
                                                       "KHR_lights_punctual",
                                                       "KHR_materials_anisotropy",
                                                       "KHR_materials_clearcoat",
                                                       "KHR_materials_diffuse_transmission",
                                                       "KHR_materials_dispersion",
                                                       "KHR_materials_emissive_strength",
                                                       "KHR_materials_ior",
                                                       "KHR_materials_iridescence",
                                                       "KHR_materials_pbrSpecularGlossiness",
                                                       "KHR_materials_sheen",
                                                       "KHR_materials_specular",
                                                       "KHR_materials_transmission",
                                                       "KHR_materials_unlit",
                                                       "KHR_materials_volume",
                                                       "KHR_mesh_quantization",
                                                       "KHR_meshopt_compression",
                                                       "KHR_node_visibility",
                                                       "KHR_texture_basisu",
                                                       "KHR_texture_transform",
                                                       "KHR_xmp",
                                                       "KHR_xmp_json_ld",
                                                       "MSFT_texture_dds"};
  return std::ranges::find(kKnown, name) != kKnown.end();
}

using Counts = std::map<std::string, std::size_t>;

// Returns how many objects of the file have each extension.
Counts extensions_in(const json& root) {
  Counts counts;
  std::vector<const json*> open = {&root};
  while (!open.empty()) {
    const json& value = *open.back();
    open.pop_back();
    for (const auto& [key, member] : value.items()) {
      if (member.is_structured()) open.push_back(&member);
      if (key != "extensions" || !value.is_object() || !member.is_object()) continue;
      for (const auto& [name, extension] : member.items()) ++counts[name];
    }
  }
  return counts;
}

// Returns whether it is a set beyond the two of coordinates and the one of colours that are read.
bool is_further_set(std::string_view attribute) {
  if (attribute.starts_with("TEXCOORD_")) return attribute != "TEXCOORD_0" && attribute != "TEXCOORD_1";
  return attribute.starts_with("COLOR_") && attribute != "COLOR_0";
}

void count_sets(const JsonNode& primitive, Counts& sets, Counts& moved) {
  if (const auto attributes = primitive.find("attributes"))
    for (const auto& [name, accessor] : attributes->members()) sets[name] += is_further_set(name);
  if (const auto targets = primitive.find("targets"))
    for (const JsonNode& target : targets->elements())
      for (const auto& [name, accessor] : target.members())
        moved[name] += name.starts_with("TEXCOORD_") || name.starts_with("COLOR_");
}

std::string counted(std::size_t n, const char* one, const char* several) {
  return std::to_string(n) + " " + (n == 1 ? one : several);
}

}  // namespace

std::vector<std::string> left_out_of(Document& document, bool at_rest) {
  std::vector<std::string> out;
  Counts used = extensions_in(document.json());
  std::set<std::string> required;
  if (const auto names = document.root().find("extensionsRequired"))
    for (const JsonNode& name : names->elements()) required.insert(name.string());
  for (const std::string& name : required) used.try_emplace(name);
  for (const auto& [name, n] : used)
    if (!is_known(name))
      out.push_back(printable(name) + (n > 0 ? " of " + counted(n, "object", "objects") : "") +
                    " is left out" + (required.contains(name) ? ", though the file requires it" : ""));
  Counts sets, moved;
  for (const JsonNode& mesh : document.entries("meshes"))
    for (const JsonNode& primitive : mesh["primitives"].elements()) count_sets(primitive, sets, moved);
  for (const auto& [name, n] : sets)
    if (n > 0)
      out.push_back(printable(name) + " of " + counted(n, "primitive", "primitives") + " is left out");
  for (const auto& [name, n] : moved)
    if (n > 0)
      out.push_back(printable(name) + " of " + counted(n, "morph target", "morph targets") + " is left out");
  const std::size_t n_scenes = document.entries("scenes").size(),
                    n_animations = document.entries("animations").size();
  if (n_scenes > 1)
    out.push_back(counted(n_scenes - 1, "further scene is", "further scenes are") + " left out");
  if (at_rest && n_animations > 0)
    out.push_back(counted(n_animations, "animation is", "animations are") +
                  " at rest; --time SECONDS shows a moment of one");
  return out;
}

}  // namespace kdray::scene::gltf
