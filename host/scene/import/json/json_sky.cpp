#include "scene/import/json/json_sky.h"

#include "scene/textures/sky_picture.h"

namespace kdray::scene {

namespace {

SkyStop read_stop(const JsonNode& node) {
  node.expect_keys(json_keys::kStop);
  return {node["height"].number_between(-1, 1), node["color"].color()};
}

Sky read_gradient(const JsonNode& node) {
  node.expect_keys(json_keys::kGradient);
  Sky sky{.kind = SkyKind::gradient};
  for (const JsonNode& stop : node["stops"].elements()) sky.stops.push_back(read_stop(stop));
  return sky;
}

Sky read_picture(const JsonNode& node, const std::filesystem::path& folder, Scene& scene) {
  node.expect_keys(json_keys::kSkyPicture);
  Sky sky{.kind = SkyKind::picture};
  if (const auto turn = node.find("turn")) sky.turn = glm::radians(turn->number());
  if (const auto strength = node.find("strength")) sky.strength = strength->number_between(0, 1e6);
  sky.picture = read_sky_picture(folder / node["file"].string(), scene.warnings);
  return sky;
}

}  // namespace

void read_background(const JsonNode& node, const std::filesystem::path& folder, Scene& scene) {
  if (!node.is_object()) {
    scene.background = node.color();
    return;
  }
  const JsonNode type = node["type"];
  const std::string name = type.string();
  if (name != "gradient" && name != "picture") throw type.expected("one of gradient, picture");
  Sky sky = name == "gradient" ? read_gradient(node) : read_picture(node, folder, scene);
  if (const auto up = node.find("up")) sky.up = up->direction();
  if (const char* const fault = fault_of(sky)) throw node.error(fault);
  sky.brightest = brightest_of(sky);
  scene.sky = std::move(sky);
}

}  // namespace kdray::scene
