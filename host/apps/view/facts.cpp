#include "apps/view/facts.h"

#include <cstdint>
#include <nlohmann/json.hpp>

#include "accel/prepare/prepared.h"
#include "io/image/color.h"
#include "scene/model/frame.h"
#include "scene/model/scene.h"

namespace kdray::view {

namespace {

using Json = nlohmann::json;

// Names of files may be of any bytes.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const Camera& camera) {
  return {{"from", camera.from},
          {"at", camera.at},
          {"up", camera.up},
          {"fov", camera.fov},
          {"ortho", camera.ortho_width}};
}

Json json_of(const vec3& color) {
  return {color.x, color.y, color.z};
}

// Times are in milliseconds; those of stages are device time, added over the queues.
Json times_of(const Statistics::Seconds& s) {
  Json times = {{"render", s.render * 1e3},
                {"prepare", s.prepare * 1e3},
                {"trace", s.trace * 1e3},
                {"shade", s.shade * 1e3}};
  if (s.admit) times["admit"] = *s.admit * 1e3;
  if (s.add) times["add"] = *s.add * 1e3;
  if (s.divide) times["divide"] = *s.divide * 1e3;
  if (s.route) times["route"] = *s.route * 1e3;
  return times;
}

Json rays_of(const Statistics::Rays& rays) {
  Json json = {{"total", rays.total}};
  if (!rays.kinds) return json;
  const Statistics::Rays::Kinds& k = *rays.kinds;
  const Statistics::Rays::Skipped& s = k.skipped;
  json["eye"] = k.primary;
  json["shadow"] = k.shadow;
  json["reflected"] = k.reflected;
  json["refracted"] = k.refracted;
  json["skipped"] = {
      {"light behind the surface", s.light_behind},   {"light of no weight", s.light_of_no_weight},
      {"light in the open", s.light_in_the_open},     {"into the background", s.of_the_background},
      {"below the least weight", s.below_min_weight}, {"too deep", s.too_deep}};
  return json;
}

Json queues_of(const Statistics::Division& division) {
  Json queues = Json::array();
  for (const Statistics::Queue& q : division.per_queue) {
    Json queue = {{"number", q.number},
                  {"color", image::queue_color(q.number)},
                  {"busy", q.busy_seconds * 1e3},
                  {"idle", q.idle_share},
                  {"rays", q.rays}};
    if (q.tiles) queue["tiles"] = *q.tiles;
    if (q.travel)
      queue.update(
          {{"subtrees", q.travel->subtrees}, {"in", q.travel->rays_in}, {"out", q.travel->rays_out}});
    queues.push_back(queue);
  }
  return queues;
}

Json figures_of(const Statistics& s) {
  Json json = {{"ms", times_of(s.seconds)},
               {"rays", rays_of(s.rays)},
               {"mrays", s.mrays_per_s},
               {"mode", s.mode.name},
               {"traversal", s.mode.traversal}};
  if (s.samples) json["samples"] = s.samples->per_pixel;
  if (s.samples && s.samples->adaptive) json["error"] = s.samples->adaptive->estimated_rmse;
  if (!s.mode.division) return json;
  json["why"] = s.mode.division->why;
  json["queues"] = queues_of(*s.mode.division);
  if (s.mode.division->odprt)
    json["travelled"] = {{"rays", s.mode.division->odprt->rays_total},
                         {"bytes", s.mode.division->odprt->bytes_total}};
  return json;
}

}  // namespace

std::string scene_message(std::span<const SceneSource> sources, std::size_t number,
                          const SceneRenderer& renderer, bool again) {
  const Settings& settings = renderer.settings();
  const scene::Scene& scene = renderer.scene().settings();
  const RenderOptions& given = settings.render;
  scene::RenderSettings asked = scene::settings_of(scene);
  scene::set_size(asked, given.width, given.height);
  Json json = {{"type", "scene"}, {"scene", number}, {"again", again}};
  for (const SceneSource& source : sources) json["names"].push_back(source.name);
  const int width = asked.width.value_or(0), height = asked.height.value_or(0);
  json["size"] = given.width > 0 ? Json{width, height} : Json(nullptr);
  json["camera"] = json_of(renderer.camera(width, height));
  const DBox& box = scene.framing.box;
  json["box"] =
      box.empty() ? Json(nullptr) : Json{{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}};
  json["depth"] = given.depth > 0 ? given.depth : asked.depth.value_or(5);
  json["samples"] = given.samples > 0 ? Json(given.samples) : Json("adaptive");
  const bool is_plain = settings.look == kdray::Look::plain;
  json["look"] = is_plain ? "plain" : scene.framing.studio ? "studio" : "as given";  // by the file
  json["headlight"] = settings.view.headlight;
  if (number < sources.size() && !sources[number].file.empty())
    json["smooth"] = settings.load.smooth_degrees.value_or(0);
  json["queues"] = settings.device.queues;
  const prepare::Prepared& prepared = renderer.scene().prepared();
  json["primitives"] = prepared.counts.primitives;
  json["nodes"] = prepared.tree_nodes;
  json["tree_depth"] = prepared.tree_depth;
  json["lights"] = scene.lights.size();
  json["materials"] = scene.materials.size();
  json["warnings"] = scene.warnings;
  return text_of(json);
}

std::string frame_message(const FrameFacts& f) {
  Json json = {{"type", "frame"},
               {"frame", f.frame},
               {"look", f.look},
               {"width", f.width},
               {"height", f.height},
               {"kind", f.kind},
               {"mime", f.type},
               {"encode", f.encode_seconds * 1e3},
               {"wall", f.wall_seconds * 1e3}};
  if (!f.command.empty()) json["command"] = f.command;
  if (f.statistics) json["figures"] = figures_of(*f.statistics);
  return text_of(json);
}

std::string picked_message(std::uint32_t number, const std::optional<Picked>& picked,
                           const PreparedScene& scene) {
  Json json = {{"type", "picked"}, {"number", number}, {"hit", picked.has_value()}};
  if (!picked) return text_of(json);
  const Picked& p = *picked;
  json.update({{"distance", p.distance},
               {"point", p.point},
               {"normal", p.normal},
               {"kind", p.kind},
               {"primitive", p.primitive}});
  if (p.instance)
    json["instance"] = *p.instance;
  else
    json.update({{"geometry", p.geometry}, {"name", p.geometry_name}});
  if (!p.part.empty()) json["part"] = p.part;
  const auto& materials = scene.settings().materials;
  if (!p.material || *p.material >= materials.size()) return text_of(json);
  const scene::Material& m = materials[*p.material];
  json["material"] = {{"number", *p.material},
                      {"diffuse", json_of(m.diffuse)},
                      {"specular", json_of(m.specular)},
                      {"reflect", json_of(m.reflect)},
                      {"transmit", json_of(m.transmit)},
                      {"shine", m.shine},
                      {"index", m.index}};
  if (const auto& names = scene.settings().names; names && !names->of_material(*p.material).empty())
    json["material"]["name"] = names->of_material(*p.material);
  return text_of(json);
}

std::string cells_message(std::size_t scene, int depth, const std::vector<DBox>& cells) {
  Json boxes = Json::array();
  for (const DBox& b : cells) boxes.push_back({b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z});
  return text_of({{"type", "cells"}, {"scene", scene}, {"depth", depth}, {"boxes", boxes}});
}

std::string problem_message(const std::string& about, const std::string& what) {
  return text_of({{"type", "problem"}, {"about", about}, {"text", what}});
}

std::string busy_message(const std::string& what) {
  return text_of({{"type", "busy"}, {"text", what}});
}

Bytes make_frame(std::string_view head, std::string_view picture) {
  std::string bytes;
  bytes.reserve(4 + head.size() + picture.size());
  for (int k = 0; k < 4; ++k) bytes += static_cast<char>(static_cast<std::uint32_t>(head.size()) >> (8 * k));
  bytes += head;
  bytes += picture;
  return std::make_shared<const std::string>(std::move(bytes));
}

}  // namespace kdray::view
