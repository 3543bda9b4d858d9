// What    kdray's own scene format: camera, lights, materials and render settings in JSON, objects inline or
//         from mesh files. docs/scenes.md describes it, docs/scene.schema.json defines it, json_keys.h lists
//         its keys.
// Units   Angles in degrees; `fov` is the full vertical field of view; colours linear RGB, a single number is
//         grey.
// Errors  "file:line" for what is not JSON, "file: /path/of/the/value" for what is not a scene.
#include <filesystem>

#include "scene/import/importers.h"
#include "scene/import/json/json_lights.h"
#include "scene/import/json/json_node.h"
#include "scene/import/json/json_objects.h"
#include "scene/import/json/json_sky.h"
#include "scene/model/check_scene.h"

namespace kdray::scene {

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
  if (const auto depth = node.find("depth")) settings.depth = depth->integer(1, 1000);
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
