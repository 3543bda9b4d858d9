#include "scene/import/gltf/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace kdray::scene::gltf {

namespace {

constexpr std::uint64_t kDefault = ~std::uint64_t{0};
constexpr float kAmbient = KDRAY_METAL_AMBIENT;
// The strength of a perfectly smooth dielectric's highlight. Physically it is 0.04 times a very large peak; a
// hard Phong lobe of this height looks about like it.
constexpr float kHighlight = KDRAY_METAL_HIGHLIGHT;
// Where a picture would say how metallic and how rough a surface is, and can't be read: a plain, half-rough
// dielectric. The factors alone (usually 1) would make it a perfect mirror or a black one.
constexpr float kUnknownRoughness = 0.5f;
constexpr float kMostColor = 1e6f;

// The surface in the terms of glTF.
struct Surface {
  vec3 base{1};
  float alpha = 1;
  float metallic = 1;
  float roughness = 1;
  float transmission = 0;
  float index = 1.5f;
  bool is_body = false;  // refracts; otherwise a thin sheet
  vec3 emission{0};
  Alpha mode = Alpha::opaque;
  float cutoff = 0.5f;
};

float factor(const JsonNode& object, std::string_view key, double otherwise) {
  return static_cast<float>(std::clamp(number_or(object, key, otherwise), 0.0, 1.0));
}

// `key`'s colour of at least three numbers, not below 0; `alpha`, where wanted, is the fourth.
vec3 color(const JsonNode& object, std::string_view key, const vec3& otherwise, float* alpha = nullptr) {
  const auto node = object.find(key);
  if (!node) return otherwise;
  const std::vector<JsonNode> parts = node->elements();
  if (parts.size() < 3) throw node->expected("[red, green, blue]");
  const auto part = [&](std::size_t i) {
    return static_cast<float>(std::clamp(parts[i].number(), 0.0, double{kMostColor}));
  };
  if (alpha && parts.size() > 3) *alpha = std::min(part(3), 1.0f);
  return {part(0), part(1), part(2)};
}

// Phong's exponent for (R.V) with a lobe as wide as that of the GGX roughness: 2/alpha^2 - 2 is the exponent
// of (N.H), and the half vector turns by a quarter of its lobe's solid angle.
float shine_of(float roughness) {
  const float alpha = std::max(roughness * roughness, 0.02f);
  return std::max(1.0f, (2 / (alpha * alpha) - 2) / 4);
}

float mean_fresnel(float index) {
  const float r = (index - 1) / (index + 1);
  return r * r + (1 - r * r) / 21;
}

Material whitted(const Surface& s) {
  const float smooth = 1 - s.roughness;
  const vec3 metal = s.metallic * s.base;
  const vec3 dielectric = (1 - s.metallic) * s.base;
  Material m;
  // A rough metal spreads what it reflects; one mirror ray can't, so that share is diffuse.
  m.diffuse = s.alpha * ((1 - s.transmission) * dielectric + s.roughness * metal);
  m.ambient = kAmbient * m.diffuse;
  m.specular = s.alpha * smooth * (kHighlight * (1 - s.metallic) + metal);
  m.shine = shine_of(s.roughness);
  m.reflect = s.alpha * smooth * metal;
  m.transmit = s.transmission * dielectric;
  if (s.transmission > 0) {
    const float mirrored = mean_fresnel(s.index) * smooth;
    m.reflect += vec3(s.alpha * s.transmission * (1 - s.metallic) * mirrored);
    m.transmit *= 1 - mirrored;
  }
  m.transmit = s.alpha * m.transmit + vec3(1 - s.alpha);
  m.reflect = glm::min(m.reflect, vec3(1) - glm::min(m.transmit, vec3(1)));
  if (s.is_body) m.index = s.index;
  m.emission = s.emission;
  return m;
}

vec3 emission_of(const JsonNode& node) {
  const auto strength = extension(node, "KHR_materials_emissive_strength");
  const double times = strength ? number_or(*strength, "emissiveStrength", 1) : 1;
  return color(node, "emissiveFactor", vec3(0)) * static_cast<float>(std::clamp(times, 0.0, 1e6));
}

void read_metallic_roughness(const JsonNode& node, Surface& s) {
  s.base = color(node, "baseColorFactor", vec3(1), &s.alpha);
  s.metallic = factor(node, "metallicFactor", 1);
  s.roughness = factor(node, "roughnessFactor", 1);
}

void read_transparency(const JsonNode& node, Surface& s) {
  if (const auto transmission = extension(node, "KHR_materials_transmission")) {
    s.transmission = factor(*transmission, "transmissionFactor", 0);
  }
  const auto ior = extension(node, "KHR_materials_ior");
  // 0 stands for an index without bound there.
  if (ior) s.index = static_cast<float>(std::clamp(number_or(*ior, "ior", 1.5), 0.0, 100.0));
  if (s.index < 1) s.index = s.index == 0 ? 100.0f : 1.0f;
  const auto volume = extension(node, "KHR_materials_volume");
  s.is_body = s.transmission > 0 && (ior || (volume && number_or(*volume, "thicknessFactor", 0) > 0));
}

void read_alpha(const JsonNode& node, Surface& s) {
  const auto mode = node.find("alphaMode");
  if (mode && mode->string() == "BLEND") s.mode = Alpha::blend;
  if (mode && mode->string() == "MASK") s.mode = Alpha::mask;
  s.cutoff = static_cast<float>(std::clamp(number_or(node, "alphaCutoff", 0.5), 0.0, 1e6));
}

Material unlit(const Surface& s) {
  return {.emission = s.alpha * s.base, .transmit = vec3(1 - s.alpha)};
}

void read_glossiness(const JsonNode& node, Surface& s) {
  s.base = color(node, "diffuseFactor", vec3(1), &s.alpha);
  s.metallic = 0;
  s.roughness =
      node.find("specularGlossinessTexture") ? kUnknownRoughness : 1 - factor(node, "glossinessFactor", 1);
}

Material specular_glossiness(const JsonNode& node, const Surface& s) {
  Material m = whitted(s);
  m.specular = s.alpha * (1 - s.roughness) * color(node, "specularFactor", vec3(1));
  return m;
}

// Returns the terms of a surface whose base colour is multiplied by something else at each place: what
// doesn't depend on it stays the material's, the rest goes to its maps.
Material with_maps(const Surface& s, const std::function<Material(const Surface&)>& terms,
                   MaterialMaps& maps) {
  Surface opaque = s, black = s;
  opaque.alpha = black.alpha = 1;
  black.base = vec3(0);
  const Material all = terms(opaque);
  Material plain = terms(black);
  plain.transmit = glm::min(plain.transmit, all.transmit);
  plain.reflect = glm::min(plain.reflect, all.reflect);
  plain.index = all.index;
  maps.emission = all.emission - plain.emission;
  maps.ambient = all.ambient - plain.ambient;
  maps.diffuse = all.diffuse - plain.diffuse;
  maps.specular = all.specular - plain.specular;
  maps.reflect = all.reflect - plain.reflect;
  maps.transmit = all.transmit - plain.transmit;
  maps.alpha = s.alpha;
  maps.cutoff = s.cutoff;
  maps.mode = s.mode;
  return plain;
}

// Returns what a surface is made of where a picture says how metallic and rough it is.
Material metal(const Surface& s, MaterialMaps& maps) {
  maps.metal = {.base = s.base,
                .metallic = s.metallic,
                .roughness = s.roughness,
                .transmission = s.transmission,
                .mirrored = s.transmission > 0 ? mean_fresnel(s.index) : 0};
  maps.alpha = s.alpha;
  maps.cutoff = s.cutoff;
  maps.mode = s.mode;
  return {.emission = s.emission, .index = s.is_body ? s.index : 1};
}

bool shows_pictures(const MaterialMaps& c) {
  return std::ranges::any_of(std::array{c.base, c.normal_map, c.emission_map, c.occlusion_map, c.metal_map},
                             [](std::uint32_t map) { return map != kNone; });
}

// Extensions that change how a surface looks and that no term of Whitted's stands for; each does nothing
// while its factor is 0.
struct LayerExtension {
  std::string_view name, factor;
  double otherwise;  // the factor when it is not given
};
constexpr LayerExtension kLayers[] = {{"KHR_materials_clearcoat", "clearcoatFactor", 0},
                                      {"KHR_materials_iridescence", "iridescenceFactor", 0},
                                      {"KHR_materials_anisotropy", "anisotropyStrength", 0},
                                      {"KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", 0},
                                      {"KHR_materials_dispersion", "dispersion", 0},
                                      {"KHR_materials_sheen", "", 1},
                                      {"KHR_materials_specular", "", 1}};

}  // namespace

void Materials::count_left_out(const JsonNode& node) {
  for (const LayerExtension& layer : kLayers)
    if (const auto found = extension(node, layer.name))
      left_out_[std::string(layer.name)] += number_or(*found, layer.factor, layer.otherwise) != 0;
  const auto count = [this](const JsonNode& holder, std::string_view key) {
    if (holder.find(key)) ++left_out_[std::string(key)];
  };
  if (const auto glossy = extension(node, "KHR_materials_pbrSpecularGlossiness"))
    count(*glossy, "specularGlossinessTexture");
}

// Of metallic-roughness, or of specular-glossiness where a material has that.
std::optional<std::uint32_t> Materials::base_texture(const JsonNode& node) {
  const auto glossy = extension(node, "KHR_materials_pbrSpecularGlossiness");
  const auto holder = glossy ? glossy : node.find("pbrMetallicRoughness");
  const auto info = holder ? holder->find(glossy ? "diffuseTexture" : "baseColorTexture") : std::nullopt;
  return info ? textures_.number_of(*info, true) : std::nullopt;
}

// Linear, but for emission's; none where the picture can't be read.
std::uint32_t Materials::map_of(const JsonNode& holder, std::string_view key, bool curved) {
  const auto info = holder.find(key);
  return info ? textures_.number_of(*info, curved).value_or(kNone) : kNone;
}

// Emission comes with a picture nearly always with the factor 1: where the picture can't be read, that would
// make the whole object a lamp.
void Materials::read_maps(const JsonNode& node, bool has_metal, MaterialMaps& maps, vec3& emission) {
  maps.normal_map = map_of(node, "normalTexture", false);
  maps.occlusion_map = map_of(node, "occlusionTexture", false);
  const auto scale = [&node](std::string_view key, std::string_view factor, double least, double most) {
    const auto info = node.find(key);
    return static_cast<float>(info ? std::clamp(number_or(*info, factor, 1), least, most) : 1.0);
  };
  maps.normal_scale = scale("normalTexture", "scale", -1e3, 1e3);
  maps.occlusion = scale("occlusionTexture", "strength", 0, 1);
  if (node.find("emissiveTexture")) {
    maps.emission_map = map_of(node, "emissiveTexture", true);
    if (maps.emission_map != kNone) maps.emissive = emission;
    emission = vec3(0);
  }
  if (const auto pbr = node.find("pbrMetallicRoughness"); pbr && has_metal)
    maps.metal_map = map_of(*pbr, "metallicRoughnessTexture", false);
}

Material Materials::read(const JsonNode* node, Corners at) {
  Surface s;
  std::function<Material(const Surface&)> terms = whitted;
  const bool colored = at.colors;
  MaterialMaps maps{.colored = colored};
  if (node) {
    count_left_out(*node);
    const bool flat = extension(*node, "KHR_materials_unlit").has_value();
    const auto glossy = extension(*node, "KHR_materials_pbrSpecularGlossiness");
    const auto pbr = node->find("pbrMetallicRoughness");
    if (pbr) read_metallic_roughness(*pbr, s);
    read_transparency(*node, s);
    read_alpha(*node, s);
    s.emission = emission_of(*node);
    if (!flat) read_maps(*node, !glossy, maps, s.emission);
    maps.tangents = at.tangents && maps.normal_map != kNone;
    if (pbr && pbr->find("metallicRoughnessTexture") && maps.metal_map == kNone)
      s.metallic = 0, s.roughness = kUnknownRoughness;
    if (glossy) {
      read_glossiness(*glossy, s);
      terms = [glossy = *glossy](const Surface& surface) { return specular_glossiness(glossy, surface); };
    }
    if (flat) terms = unlit;
    if (const auto base = base_texture(*node)) maps.base = *base;
  }
  const bool has_hole = s.mode == Alpha::mask && s.alpha < s.cutoff;
  const bool has_maps = shows_pictures(maps) || colored || has_hole;
  if (s.mode != Alpha::blend && maps.base == kNone && !colored && !has_hole) s.alpha = 1;
  if (!has_maps) return terms(s);
  Material m = maps.metal_map != kNone ? metal(s, maps) : with_maps(s, terms, maps);
  m.maps = scene_.texturing.add(maps);
  return m;
}

std::uint32_t Materials::number_of(const JsonNode& primitive, Corners at) {
  const auto index = primitive.find("material");
  const JsonNode* const node = index ? &document_.entry("materials", *index) : nullptr;
  at.tangents = at.tangents && node && node->find("normalTexture");
  const auto [it, added] = numbers_.try_emplace({index ? whole(*index) : kDefault, at},
                                                static_cast<std::uint32_t>(scene_.materials.size()));
  if (!added) return it->second;
  if (node) names_.name_material(it->second, name_of(*node));
  scene_.materials.push_back(read(node, at));
  return it->second;
}

void Materials::warn() {
  for (const auto& [what, n] : left_out_)
    if (n > 0)
      scene_.warnings.push_back(document_.file() + ": " + what + " of " + std::to_string(n) +
                                (n == 1 ? " material" : " materials") + " is left out");
}

}  // namespace kdray::scene::gltf
