#include "scene/import/gltf/gltf_lights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/model/check_scene.h"

namespace kdray::scene::gltf {

namespace {

constexpr double kHalfPi = 1.5707963267948966;

// Returns the ratio of a picture's sides; 0 where they make no picture.
double ratio_or_none(double width, double height) {
  const double ratio = width / height;
  return ratio > 0 && std::isfinite(ratio) ? ratio : 0;
}

vec3 color_of(const JsonNode& light) {
  vec3 color(1);
  if (const auto node = light.find("color")) color = node->color();
  const double intensity = std::clamp(number_or(light, "intensity", 1), 0.0, 1e12);
  return glm::min(color, vec3(1e12f)) * static_cast<float>(intensity);
}

dvec3 direction_or(const dvec3& v, const dvec3& otherwise) {
  const double length = glm::length(v);
  return std::isfinite(length) && length > 0 ? v / length : otherwise;
}

void read_cone(const JsonNode& light, Light& out) {
  const auto spot = light.find("spot");
  const double inner = spot ? number_or(*spot, "innerConeAngle", 0) : 0;
  const double outer = spot ? number_or(*spot, "outerConeAngle", kHalfPi / 2) : kHalfPi / 2;
  out.cos_outer = static_cast<float>(std::cos(std::clamp(outer, 0.0, kHalfPi)));
  out.cos_inner = std::max(out.cos_outer, static_cast<float>(std::cos(std::clamp(inner, 0.0, kHalfPi))));
}

float brightness(const vec3& color) {
  return std::max({color.x, color.y, color.z});
}

// Returns a light's illuminance at a place that it points at, without shadows, its cone and its range.
double illuminance(const Light& light, const dvec3& at, double nearest) {
  if (light.kind == LightKind::directional) return brightness(light.color);
  const double distance = std::max(glm::length(light.position - at), nearest);
  return brightness(light.color) / (distance * distance);
}

}  // namespace

Light read_light(const JsonNode& light, const dmat4& to_world) {
  Light out;
  const std::string type = light["type"].string();
  if (type == "directional") {
    out.kind = LightKind::directional;
  } else if (type == "spot") {
    out.kind = LightKind::spot;
  } else if (type != "point") {
    throw light["type"].expected("directional, point or spot");
  }
  out.color = color_of(light);
  out.position = dvec3(to_world[3]);
  if (out.kind != LightKind::point) out.direction = direction_or(-dvec3(to_world[2]), dvec3(0, 0, -1));
  if (out.kind == LightKind::spot) read_cone(light, out);
  if (out.kind != LightKind::directional) {
    out.attenuation = dvec3(0, 0, 1);
    const double range = number_or(light, "range", 0);
    if (range > 0) out.range = range;
  }
  return out;
}

void expose(Scene& scene) {
  const DBox box = scene.bounds();
  const dvec3 middle = box.empty() ? dvec3(0) : box.center();
  // A lamp inside the scene is judged from the distance of the walls, not from its own surface.
  const double size = box.empty() ? 0 : glm::length(box.extent());
  const double nearest = size > 0 ? size / 4 : 1e-6;
  double sum = 0;
  for (const Light& light : scene.lights) sum += illuminance(light, middle, nearest);
  if (!(sum > 0) || !std::isfinite(sum)) return;
  scene.framing.illuminance = sum;
  for (Light& light : scene.lights) {
    const dvec3 color = dvec3(light.color) / sum;
    constexpr double kMost = std::numeric_limits<float>::max();
    light.color = vec3(glm::min(color, dvec3(kMost)));
  }
}

void aim_cameras(Scene& scene) {
  if (scene.cameras.empty()) return;
  const DBox box = scene.bounds();
  if (box.empty()) return;
  for (Camera& camera : scene.cameras) {
    const dvec3 forward = camera.at - camera.from;
    const double depth = glm::dot(box.center() - camera.from, forward);
    if (depth > 0.01 * glm::length(box.extent())) camera.at = camera.from + depth * forward;
  }
}

std::optional<Camera> read_camera(const JsonNode& camera, const dmat4& to_world,
                                  std::vector<std::string>& warnings) {
  Camera out;
  const bool parallel = camera["type"].string() == "orthographic";
  const JsonNode lens = camera[parallel ? "orthographic" : "perspective"];
  if (parallel) {
    out.ortho_width = 2 * std::abs(number_or(lens, "xmag", 0));
    out.aspect = ratio_or_none(out.ortho_width, 2 * std::abs(number_or(lens, "ymag", 0)));
  } else {
    out.vertical_fov = lens["yfov"].number();
    out.aspect = ratio_or_none(number_or(lens, "aspectRatio", 0), 1);
  }
  out.hither = std::max(0.0, number_or(lens, "znear", 0));
  out.from = dvec3(to_world[3]);
  out.at = out.from + direction_or(-dvec3(to_world[2]), dvec3(0, 0, -1));
  out.up = direction_or(dvec3(to_world[1]), dvec3(0, 1, 0));
  const char* fault = fault_of(out);
  if (!fault && parallel && out.ortho_width == 0) fault = "'xmag' is 0";
  if (!fault) return out;
  warnings.push_back(camera.file() + ": a camera is left out: " + fault);
  return std::nullopt;
}

}  // namespace kdray::scene::gltf
