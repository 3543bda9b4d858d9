// What    kdray's own scene format: camera, lights, materials and render settings in JSON, objects inline or
//         from mesh files. docs/scenes.md describes it, docs/scene.schema.json defines it, json_keys.h lists
//         its keys.
// Units   Angles in degrees; `fov` is the full vertical field of view; colours linear RGB, a single number is
//         grey.
// Errors  "file:line" for what is not JSON, "file: /path/of/the/value" for what is not a scene.
#include <cmath>
#include <filesystem>

#include "layout/frame.layout.h"
#include "scene/import/json/json_node.h"
#include "scene/import/json/json_objects.h"
#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/model/scene.h"
#include "scene/textures/sky.h"

namespace kdray::scene {

// ---- lights

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

}  // namespace

// ---- the background

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

// Pictures are looked for in `folder`.
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

}  // namespace

// ---- the scene

namespace {

Camera read_camera(const JsonNode& node) {
  node.expect_keys(json_keys::kCamera);
  Camera camera;
  camera.from = node["from"].vector();
  camera.at = node["at"].vector();
  if (const auto up = node.find("up")) camera.up = up->vector();
  if (const auto fov = node.find("fov"))
    camera.vertical_fov = glm::radians(fov->number_between(1e-6, 179.999));
  if (const auto width = node.find("ortho")) {
    if (node.find("fov")) throw width->error("a camera has either 'fov' or 'ortho'");
    camera.ortho_width = width->number_above(0);
  }
  if (const auto hither = node.find("hither")) camera.hither = hither->number_from(0);
  if (const auto aperture = node.find("aperture")) camera.aperture = aperture->number_from(0);
  if (const auto focus = node.find("focus")) camera.focus = focus->number_above(0);
  if (const char* fault = fault_of(camera)) throw node.error(fault);
  return camera;
}

RenderSettings read_settings(const JsonNode& node) {
  node.expect_keys(json_keys::kRender);
  RenderSettings settings;
  if (const auto size = node.find("size")) {
    if (!size->is_array() || size->size() != 2) throw size->expected("[width, height]");
    const auto sides = size->elements();
    settings.width = sides[0].integer(1, 65536);
    settings.height = sides[1].integer(1, 65536);
  }
  if (const auto depth = node.find("depth")) settings.depth = depth->integer(1, KDRAY_MAX_DEPTH);
  if (const auto samples = node.find("samples")) settings.samples = samples->integer(1, 65536);
  if (const auto weight = node.find("min_weight")) settings.min_weight = weight->number_between(0, 1);
  return settings;
}

void check_head(const JsonNode& root) {
  root.expect_keys(json_keys::kScene);
  if (const auto schema = root.find("$schema")) (void)schema->string();
  if (const auto version = root.find("kdray")) (void)version->integer(1, 1);
}

}  // namespace

Scene read_json(std::string_view text, const std::filesystem::path& file) {
  const std::string name = file.string();
  const nlohmann::json document = parse_json(text, name);
  const JsonNode root(document, name);
  check_head(root);
  Scene scene;
  if (const auto camera = root.find("camera")) scene.camera = read_camera(*camera);
  if (const auto background = root.find("background"))
    read_background(*background, file.parent_path(), scene);
  if (const auto ambient = root.find("ambient")) scene.ambient = ambient->color();
  if (const auto render = root.find("render")) scene.settings = read_settings(*render);
  if (const auto lights = root.find("lights")) {
    for (const JsonNode& light : lights->elements()) scene.lights.push_back(read_light(light));
    scene.unlit = scene.lights.empty();
  }
  NamedMaterials named;
  JsonMaterials reader(scene, file.parent_path());
  if (const auto materials = root.find("materials")) {
    for (const auto& [key, material] : materials->members()) named.emplace(key, reader.read(material));
  }
  JsonObjects objects(scene, named, reader, file.parent_path());
  if (const auto list = root.find("objects")) {
    for (const JsonNode& object : list->elements()) objects.read(object);
    objects.finish();
  }
  return scene;
}

}  // namespace kdray::scene
