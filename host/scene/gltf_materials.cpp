#include "scene/gltf_materials.h"

#include <algorithm>
#include <cmath>

namespace kdray::scene::gltf {

namespace {

constexpr std::uint64_t kDefault = ~std::uint64_t{0};
constexpr float kAmbient = 0.1f;
// The strength of a perfectly smooth dielectric's highlight. Physically it is 0.04 times a very large peak; a
// hard Phong lobe of this height looks about like it.
constexpr float kHighlight = 0.25f;
// Where a picture would say how metallic and how rough a surface is, and pictures are not read: a plain,
// half-rough dielectric. The factors alone (usually 1) would make it a perfect mirror or a black one.
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

// Emission comes with a picture nearly always with the factor 1, which would make the whole object a lamp.
vec3 emission_of(const JsonNode& node) {
  if (node.find("emissiveTexture")) return vec3(0);
  const auto strength = extension(node, "KHR_materials_emissive_strength");
  const double times = strength ? number_or(*strength, "emissiveStrength", 1) : 1;
  return color(node, "emissiveFactor", vec3(0)) * static_cast<float>(std::clamp(times, 0.0, 1e6));
}

void read_metallic_roughness(const JsonNode& node, Surface& s) {
  s.base = color(node, "baseColorFactor", vec3(1), &s.alpha);
  s.metallic = factor(node, "metallicFactor", 1);
  s.roughness = factor(node, "roughnessFactor", 1);
  if (node.find("metallicRoughnessTexture")) s.metallic = 0, s.roughness = kUnknownRoughness;
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
  const auto mode = node.find("alphaMode");
  if (!mode || mode->string() != "BLEND") s.alpha = 1;
}

Material unlit(const Surface& s) {
  return {.emission = s.alpha * s.base, .transmit = vec3(1 - s.alpha)};
}

Material specular_glossiness(const JsonNode& node, const Surface& rest) {
  Surface s = rest;
  s.base = color(node, "diffuseFactor", vec3(1));
  s.metallic = 0;
  s.roughness =
      node.find("specularGlossinessTexture") ? kUnknownRoughness : 1 - factor(node, "glossinessFactor", 1);
  Material m = whitted(s);
  m.specular = s.alpha * (1 - s.roughness) * color(node, "specularFactor", vec3(1));
  return m;
}

bool has_picture(const JsonNode& pbr) {
  for (const std::string_view key :
       {"baseColorTexture", "metallicRoughnessTexture", "diffuseTexture", "specularGlossinessTexture"}) {
    if (pbr.find(key)) return true;
  }
  return false;
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
  if (const auto mode = node.find("alphaMode")) left_out_["alphaMode MASK"] += mode->string() == "MASK";
}

Material Materials::read(const JsonNode& node) {
  count_left_out(node);
  Surface s;
  const auto pbr = node.find("pbrMetallicRoughness");
  if (pbr) read_metallic_roughness(*pbr, s);
  read_transparency(node, s);
  s.emission = emission_of(node);
  const auto glossy = extension(node, "KHR_materials_pbrSpecularGlossiness");
  any_picture_ = any_picture_ || (pbr && has_picture(*pbr)) || (glossy && has_picture(*glossy)) ||
                 node.find("emissiveTexture") || node.find("normalTexture");
  if (extension(node, "KHR_materials_unlit")) return unlit(s);
  return glossy ? specular_glossiness(*glossy, s) : whitted(s);
}

std::uint32_t Materials::number_of(const JsonNode& primitive) {
  const auto index = primitive.find("material");
  const auto [it, added] = numbers_.try_emplace(index ? whole(*index) : kDefault,
                                                static_cast<std::uint32_t>(scene_.materials.size()));
  if (added) scene_.materials.push_back(index ? read(document_.entry("materials", *index)) : whitted({}));
  return it->second;
}

void Materials::warn() {
  for (const auto& [what, n] : left_out_)
    if (n > 0)
      scene_.warnings.push_back(document_.file() + ": " + what + " of " + std::to_string(n) +
                                (n == 1 ? " material" : " materials") + " is left out");
  if (!any_picture_) return;
  scene_.warnings.push_back(document_.file() +
                            ": pictures (textures) are left out: the colours of the factors are used");
}

}  // namespace kdray::scene::gltf
