#include "scene/import/json/json_lights.h"

#include <cmath>

#include "scene/model/area_light.h"
#include "scene/model/check_scene.h"

namespace kdray::scene {

namespace {

void read_reach(const JsonNode& node, Light& light) {
  if (const auto range = node.find("range")) light.range = range->number_above(0);
  if (const auto attenuation = node.find("attenuation")) {
    light.attenuation = attenuation->vector();
    if (glm::any(glm::lessThan(light.attenuation, dvec3(0)))) throw attenuation->error("a value below 0");
    light.attenuation.x = static_cast<float>(light.attenuation.x);  // it is no length
    if (light.attenuation == dvec3(0)) {
      throw attenuation->expected("[constant, linear, quadratic], not all 0");
    }
  }
}

void read_cone_angles(const JsonNode& node, Light& light) {
  const double outer = node["outer"].number_between(0, 180);
  const auto inner = node.find("inner");
  const double full = inner ? inner->number_between(0, 180) : outer;
  if (full > outer) throw inner->error("the inner angle is wider than the outer one");
  light.cos_inner = static_cast<float>(std::cos(glm::radians(full)));
  light.cos_outer = static_cast<float>(std::cos(glm::radians(outer)));
}

// A rectangle has two edges, a disc a normal.
void read_area(const JsonNode& node, const std::string& name, Light& light) {
  light.position = node["position"].vector();
  if (name == "rectangle") {
    node.expect_keys(json_keys::kRectangleLight);
    light.kind = LightKind::rectangle;
    light.across = node["across"].vector();
    light.down = node["down"].vector();
  } else if (name == "sphere") {
    node.expect_keys(json_keys::kSphereLight);
    light.kind = LightKind::sphere;
    light.radius = node["radius"].number_above(0);
  } else {
    node.expect_keys(json_keys::kDiscLight);
    set_disc(light, node["normal"].direction(), node["radius"].number_above(0));
  }
  read_reach(node, light);
}

}  // namespace

Light read_light(const JsonNode& node) {
  const JsonNode type = node["type"];
  const std::string name = type.string();
  Light light;
  if (name == "point") {
    node.expect_keys(json_keys::kPointLight);
    light.position = node["position"].vector();
    read_reach(node, light);
  } else if (name == "directional") {
    node.expect_keys(json_keys::kDirectionalLight);
    light.kind = LightKind::directional;
    light.direction = node["direction"].direction();
  } else if (name == "spot") {
    node.expect_keys(json_keys::kSpotLight);
    light.kind = LightKind::spot;
    light.position = node["position"].vector();
    light.direction = node["direction"].direction();
    read_cone_angles(node, light);
    read_reach(node, light);
  } else if (name == "rectangle" || name == "sphere" || name == "disc") {
    read_area(node, name, light);
  } else {
    throw type.expected("one of point, directional, spot, rectangle, sphere, disc");
  }
  if (const auto color = node.find("color")) light.color = color->color();
  if (const char* fault = fault_of(light)) throw node.error(fault);
  return light;
}

}  // namespace kdray::scene
