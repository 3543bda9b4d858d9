#include "scene/import/json/json_objects.h"

#include <cmath>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/json/json_keys.h"
#include "scene/model/check_scene.h"
#include "scene/textures/picture.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

namespace {

vec3 color_or(const JsonNode& object, std::string_view key, const vec3& otherwise) {
  const auto node = object.find(key);
  return node ? node->color() : otherwise;
}

float narrow(const JsonNode& node, double value) {
  const auto f = static_cast<float>(value);
  if (!std::isfinite(f)) throw node.error("a value beyond 3.4e38");
  return f;
}

Material read_terms(const JsonNode& node) {
  const vec3 color = color_or(node, "color", vec3(1));
  Material m;
  m.ambient = color_or(node, "ka", vec3(0.1f)) * color;
  m.diffuse = color_or(node, "kd", vec3(0.9f)) * color;
  m.specular = color_or(node, "ks", vec3(0));
  m.reflect = color_or(node, "reflect", vec3(0));
  m.transmit = color_or(node, "transmit", vec3(0)) * color;
  m.emission = color_or(node, "emission", vec3(0));
  if (const auto shine = node.find("shine")) m.shine = narrow(*shine, shine->number_from(0));
  if (const auto index = node.find("index")) m.index = narrow(*index, index->number_above(0));
  if (const char* fault = fault_of(m)) throw node.error(fault);
  return m;
}

Alpha read_alpha(const JsonNode& node) {
  const std::string mode = node.string();
  if (mode == "opaque") return Alpha::opaque;
  if (mode == "mask") return Alpha::mask;
  if (mode == "blend") return Alpha::blend;
  throw node.expected("one of opaque, mask, blend");
}

// Returns what a picture's values are multiplied by.
float factor_of(const JsonNode& material, std::string_view key, std::string_view picture) {
  const auto node = material.find(key);
  if (!node) return 1;
  if (!material.find(picture))
    throw node->error("there is no picture that it could multiply",
                      "name one with '" + std::string(picture) + "'");
  return static_cast<float>(node->number_between(0, 1));
}

}  // namespace

std::uint32_t JsonMaterials::picture_of(const JsonNode& file) {
  const std::string name = file.string();
  const auto found = pictures_.find(name);
  if (found != pictures_.end()) return found->second;
  const std::filesystem::path path = folder_ / name;
  try {
    const auto picture = decode_picture(read_file(path), path.string(), scene_.warnings);
    return pictures_[name] = scene_.texturing.add(picture);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) throw;
    throw file.error(error.what());
  }
}

std::uint32_t JsonMaterials::texture_of(const JsonNode& material, std::string_view key, bool curved) {
  const auto file = material.find(key);
  if (!file) return kNone;
  return scene_.texturing.add(
      Texture{.picture = picture_of(*file), .minify = Minify::linear_mipmap_linear, .curved = curved});
}

// A picture multiplies what `color` does: the ambient and diffuse terms, and what goes through.
Material JsonMaterials::read(const JsonNode& node) {
  node.expect_keys(json_keys::kMaterial);
  const Material terms = read_terms(node);
  MaterialMaps maps;
  maps.base = texture_of(node, "picture", true);
  maps.normal_map = texture_of(node, "normal_picture", false);
  maps.emission_map = texture_of(node, "emission_picture", true);
  maps.metal_map = texture_of(node, "metal_picture", false);
  maps.occlusion_map = texture_of(node, "occlusion_picture", false);
  const auto alpha = node.find("alpha");
  if (alpha) maps.mode = read_alpha(*alpha);
  if (alpha && maps.base == kNone)
    throw alpha->error("there is no picture whose alpha it could mean", "name one with 'picture'");
  maps.metal = {.base = color_or(node, "color", vec3(1)),
                .metallic = factor_of(node, "metallic", "metal_picture"),
                .roughness = factor_of(node, "roughness", "metal_picture")};
  maps.occlusion = factor_of(node, "occlusion", "occlusion_picture");
  if (maps.emission_map != kNone) maps.emissive = node.find("emission") ? terms.emission : vec3(1);
  return with_pictures(terms, maps, scene_.texturing);
}

}  // namespace kdray::scene
