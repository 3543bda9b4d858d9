#include "api/statistics_json.h"

#include "device/tuning/settings.h"
#include "kdray/kdray.h"

namespace kdray::api {

namespace {

template <class Value>
void put(Json& object, const char* name, const std::optional<Value>& value) {
  if (value) object[name] = *value;
}

Json seconds_json(const Statistics::Seconds& s) {
  Json seconds = {{"cache", s.cache},
                  {"load", s.load},
                  {"start", s.start},
                  {"self_test", s.self_test},
                  {"build", s.build},
                  {"flatten", s.flatten},
                  {"upload", s.upload},
                  {"compile", s.compile},
                  {"prepare", s.prepare},
                  {"trace", s.trace},
                  {"shade", s.shade},
                  {"render", s.render},
                  {"keep_programs", s.keep_programs},
                  {"write", s.write},
                  {"total", s.total}};
  put(seconds, "admit", s.admit);
  put(seconds, "add", s.add);
  put(seconds, "divide", s.divide);
  put(seconds, "route", s.route);
  put(seconds, "read_rays", s.read_rays);
  return seconds;
}

Json scene_json(const Statistics::Scene& s) {
  Json scene = {{"primitives", s.primitives},
                {"stitches", s.stitches},
                {"lights", s.lights},
                {"materials", s.materials},
                {"dropped_degenerate", s.dropped_degenerate}};
  for (const auto& [kind, count] : s.kinds) scene[kind] = count;
  return scene;
}

Json tree_json(const Statistics::Tree& t) {
  return {{"build", t.build},
          {"nodes", t.nodes},
          {"inner_nodes", t.inner_nodes},
          {"leaves", t.leaves},
          {"empty_leaves", t.empty_leaves},
          {"references", t.references},
          {"duplication", t.duplication},
          {"largest_leaf", t.largest_leaf},
          {"max_depth", t.max_depth},
          {"mean_leaf_depth", t.mean_leaf_depth},
          {"sah_cost", t.sah_cost}};
}

Json rays_json(const Statistics::Rays& r) {
  Json rays = {{"total", r.total}};
  if (!r.kinds) return rays;
  const Statistics::Rays::Skipped& s = r.kinds->skipped;
  rays["primary"] = r.kinds->primary;
  rays["primary_hit"] = r.kinds->primary_hit;
  rays["shadow"] = r.kinds->shadow;
  rays["reflected"] = r.kinds->reflected;
  rays["refracted"] = r.kinds->refracted;
  rays["skipped"] = {{"light_behind", s.light_behind},           {"light_of_no_weight", s.light_of_no_weight},
                     {"light_in_the_open", s.light_in_the_open}, {"of_the_background", s.of_the_background},
                     {"below_min_weight", s.below_min_weight},   {"too_deep", s.too_deep},
                     {"too_deep_in_glass", s.too_deep_in_glass}};
  return rays;
}

Json memory_json(const Statistics::Memory& m) {
  Json memory = {{"scene_bytes", m.scene_bytes}};
  put(memory, "frame_bytes", m.frame_bytes);
  for (const Statistics::QueueMemory& q : m.per_queue)
    memory["per_queue"].push_back({{"geometry_bytes", q.geometry_bytes}, {"work_bytes", q.work_bytes}});
  return memory;
}

Json tuning_json(const Statistics::DeviceTuning& t) {
  Json settings = Json::object();
  for (const tuning::Setting& s : tuning::settings())
    if (t.settings.*s.value != 0) settings[std::string(s.name)] = t.settings.*s.value;
  return {{"from", t.from},
          {"settings", std::move(settings)},
          {"key",
           {{"device", t.device},
            {"driver", t.driver},
            {"kernels", t.kernels},
            {"schedule", t.schedule},
            {"features", t.features}}}};
}

Json samples_json(const Statistics::Samples& s) {
  if (!s.adaptive)
    return {{"mode", "uniform"}, {"total", s.total}, {"per_pixel", static_cast<std::uint64_t>(s.per_pixel)}};
  Json by_count = Json::object();
  for (const auto& [count, pixels] : s.adaptive->pixels) by_count[std::to_string(count)] = pixels;
  return {{"mode", "adaptive"},
          {"total", s.total},
          {"per_pixel", s.per_pixel},
          {"rounds", s.adaptive->rounds},
          {"target", s.adaptive->target},
          {"estimated_rmse", s.adaptive->estimated_rmse},
          {"stopped", s.adaptive->met ? "target" : "cap"},
          {"pixels", std::move(by_count)}};
}

Json queue_json(const Statistics::Queue& q) {
  Json queue = {{"queue", q.number},
                {"device", q.device},
                {"busy_seconds", q.busy_seconds},
                {"idle_share", q.idle_share},
                {"rays", q.rays}};
  put(queue, "tiles", q.tiles);
  put(queue, "rank", q.rank);
  if (!q.travel) return queue;
  const Statistics::Travel& t = *q.travel;
  queue.update({{"parts", t.parts},
                {"subtrees", t.subtrees},
                {"part_loads", t.part_loads},
                {"launches", t.launches},
                {"rays_in", t.rays_in},
                {"rays_out", t.rays_out},
                {"bytes_in", t.bytes_in},
                {"bytes_out", t.bytes_out}});
  return queue;
}

Json division_json(const Statistics::Division& d) {
  Json division = {{"why", d.why},
                   {"devices", d.devices},
                   {"sub_devices", d.sub_devices},
                   {"programs", d.programs},
                   {"programs_known", d.programs_known},
                   {"tile", {d.tile_width, d.tile_height}},
                   {"tiles", d.tiles},
                   {"bands", d.bands},
                   {"launches", d.launches},
                   {"waves", d.waves},
                   {"samples_of_empty_blocks", d.samples_of_empty_blocks},
                   {"schedule", d.schedule},
                   {"quarantined", Json::array()},
                   {"per_queue", Json::array()}};
  for (const Statistics::Quarantined& q : d.quarantined)
    division["quarantined"].push_back({{"queue", q.queue}, {"what", q.what}});
  for (const Statistics::Queue& q : d.per_queue) division["per_queue"].push_back(queue_json(q));
  if (d.pdprt) {
    division["division"] = d.pdprt->division;
    if (!d.pdprt->tile_seconds.empty()) division["tile_seconds"] = d.pdprt->tile_seconds;
  }
  if (d.ranks)
    division["ranks"] = {{"number", d.ranks->ranks},
                         {"messages_out", d.ranks->messages_out},
                         {"messages_in", d.ranks->messages_in},
                         {"bytes_out", d.ranks->bytes_out},
                         {"bytes_in", d.ranks->bytes_in},
                         {"scene", d.ranks->whole ? "whole" : "shares"},
                         {"peak_bytes", d.ranks->peak_bytes}};
  if (d.odprt) {
    division["balance"] = d.odprt->balance;
    division["parts"] = d.odprt->parts;
    division["directory_cells"] = d.odprt->directory_cells;
    division["whole_geometry_bytes"] = d.odprt->whole_geometry_bytes;
    division["exchange"] = {{"rays", d.odprt->rays},
                            {"bytes", d.odprt->bytes},
                            {"rays_total", d.odprt->rays_total},
                            {"bytes_total", d.odprt->bytes_total}};
  }
  return division;
}

Json mode_json(const Statistics::Mode& m) {
  Json mode = {{"name", m.name},
               {"queues", m.queues},
               {"work_group", m.work_group},
               {"traversal", m.traversal},
               {"precision", m.precision}};
  put(mode, "repeat", m.repeat);
  if (m.division) mode.update(division_json(*m.division));
  return mode;
}

}  // namespace

Json device_json(const Statistics& statistics) {
  const DeviceInfo& d = statistics.device;
  return {{"number", d.number},
          {"name", d.name},
          {"platform", d.platform},
          {"version", d.version},
          {"driver", d.driver},
          {"kind", d.kind},
          {"compute_units", d.compute_units},
          {"global_memory", d.global_memory},
          {"max_allocation", d.max_allocation},
          {"vectors", d.vectors},
          {"double_precision", d.double_precision},
          {"tuning", tuning_json(statistics.tuning)}};
}

Json statistics_json(const Statistics& s) {
  Json json = {{"seconds", seconds_json(s.seconds)},
               {"scene", scene_json(s.scene)},
               {"tree", tree_json(s.tree)},
               {"memory", memory_json(s.memory)},
               {"features", {{"on", s.features.on}, {"off", s.features.off}}},
               {"programs",
                {{"compiled", s.programs.compiled},
                 {"found", s.programs.found},
                 {"covering", s.programs.covering},
                 {"spare", s.programs.spare}}},
               {"device", device_json(s)}};
  if (s.mode.name.empty()) return json;
  json["rays"] = rays_json(s.rays);
  json["mrays_per_s"] = s.mrays_per_s;
  json["mode"] = mode_json(s.mode);
  if (s.frame)
    json["frame"] = {{"width", s.frame->width},
                     {"height", s.frame->height},
                     {"samples", s.frame->samples},
                     {"depth", s.frame->depth},
                     {"spawn_threshold", s.frame->spawn_threshold}};
  if (s.samples) json["samples"] = samples_json(*s.samples);
  if (s.ledger)
    json["ledger"] = {{"folder", s.ledger->folder},
                      {"pieces", s.ledger->pieces},
                      {"found", s.ledger->found},
                      {"rendered", s.ledger->rendered},
                      {"damaged", s.ledger->damaged},
                      {"bytes_read", s.ledger->bytes_read},
                      {"bytes_written", s.ledger->bytes_written},
                      {"seconds", s.ledger->seconds}};
  return json;
}

}  // namespace kdray::api

namespace kdray {

std::string to_json(const Statistics& statistics) {
  return api::statistics_json(statistics).dump(2);
}

}  // namespace kdray
