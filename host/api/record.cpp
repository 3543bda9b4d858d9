#include "api/record.h"

#include "accel/flatten/features.h"
#include "accel/prepare/prepared.h"
#include "api/precision.h"
#include "engine/wavefront/programs.h"

namespace kdray::api {

namespace {

Statistics::Scene scene_told(const prepare::Prepared& scene) {
  Statistics::Scene told{.primitives = scene.counts.primitives,
                         .kinds = {},
                         .stitches = scene.counts.zero_area,
                         .lights = scene.settings.lights.size(),
                         .materials = scene.settings.materials.size(),
                         .dropped_degenerate = scene.geometry.dropped_degenerate};
  primitives::for_each_kind(
      [&](auto kind) { told.kinds.emplace_back(kind.kNames, decltype(kind)::of(scene.counts)); });
  return told;
}

Statistics::Tree tree_told(const prepare::Prepared& scene) {
  const kdtree::Statistics& s = scene.tree;
  return {.build = std::string(prepare::name_of(scene.tree_options.quality)),
          .nodes = scene.tree_nodes,
          .inner_nodes = s.inner_nodes,
          .leaves = s.leaves,
          .empty_leaves = s.empty_leaves,
          .references = s.references,
          .duplication = s.duplication,
          .largest_leaf = s.largest_leaf,
          .max_depth = s.max_depth,
          .mean_leaf_depth = s.mean_leaf_depth,
          .sah_cost = s.sah_cost};
}

#define KDRAY_ONE(name, field, key) +1
static_assert(0 KDRAY_COUNTERS_OF_TRACED(KDRAY_ONE) == 5 && 0 KDRAY_COUNTERS_OF_SKIPPED(KDRAY_ONE) == 7,
              "Statistics::Rays has a field for each counter");
#undef KDRAY_ONE

Statistics::Rays rays_told(const wavefront::Counters& c) {
  return {.total = c.total(),
          .kinds = Statistics::Rays::Kinds{.primary = c.primary,
                                           .primary_hit = c.primary_hit,
                                           .shadow = c.shadow,
                                           .reflected = c.reflected,
                                           .refracted = c.refracted,
                                           .skipped = {.light_behind = c.skipped_behind,
                                                       .light_of_no_weight = c.skipped_unlit,
                                                       .light_in_the_open = c.skipped_open,
                                                       .of_the_background = c.skipped_background,
                                                       .below_min_weight = c.skipped_weight,
                                                       .too_deep = c.skipped_depth,
                                                       .too_deep_in_glass = c.skipped_glass}}};
}

Statistics::Samples samples_told(const layout::Frame& frame, const std::optional<adaptive::Report>& report) {
  const std::uint64_t pixels = std::uint64_t{frame.width} * frame.height;
  if (!report) return {pixels * frame.n_samples, static_cast<double>(frame.n_samples), {}};
  Statistics::Adaptive adaptive{report->rounds, report->target, report->estimated_rmse, report->met, {}};
  for (int level = 0; level < adaptive::kLevels; ++level)
    adaptive.pixels.emplace_back(adaptive::samples_of(level),
                                 report->pixels[static_cast<std::size_t>(level)]);
  return {report->samples, static_cast<double>(report->samples) / static_cast<double>(pixels),
          std::move(adaptive)};
}

std::optional<Statistics::Ledger> checkpoint_told(const Job& job) {
  if (!job.checkpoint) return std::nullopt;
  const checkpoint::Report r = job.checkpoint->report();
  return Statistics::Ledger{job.options.ledger->folder.string(),
                            r.records,
                            r.found,
                            r.rendered,
                            r.damaged,
                            r.bytes_read,
                            r.bytes_written,
                            r.seconds};
}

void record_preparations(Statistics& statistics, const engine::DeviceScene& devices) {
  statistics.seconds.compile = devices.build_seconds();
  statistics.seconds.upload = devices.upload_seconds();
  const wavefront::ProgramsUsed used = devices.programs_used();
  statistics.programs = {used.compiled, used.found, used.covering, flatten::feature_names(used.spare).on};
}

void add_devices(Statistics::Division& division, const engine::DeviceScene& devices) {
  for (const engine::Device& d : devices) {
    division.sub_devices += d.context.n_sub_devices();
    division.programs += d.programs.n_built();
    division.devices.push_back(d.context.info().name);
  }
  division.programs_known = devices.size() * wavefront::Programs::n_known();
}

}  // namespace

Statistics::Features features_told(layout::Features mask) {
  flatten::FeatureNames names = flatten::feature_names(mask);
  return {std::move(names.on), std::move(names.off)};
}

Statistics::DeviceTuning tuning_told(const engine::Tuned& tuned) {
  const tuning::Key& k = tuned.key;
  return {tuned.from, tuned.settings, k.device, k.driver, k.kernels, k.schedule, k.features};
}

Statistics first_statistics(const engine::DeviceScene& devices) {
  const prepare::Prepared& scene = devices.scene();
  Statistics s;
  s.seconds.start = devices.open_seconds.start;
  s.seconds.self_test = devices.open_seconds.self_test;
  s.seconds.build = scene.seconds.build;
  s.seconds.flatten = scene.seconds.flatten;
  s.scene = scene_told(scene);
  s.tree = tree_told(scene);
  s.memory.scene_bytes = scene.bytes();
  s.device = devices.first().context.info();
  s.tuning = tuning_told(devices.first().tuned());
  s.features = features_told(scene.features);
  return s;
}

void record_frame(Statistics& statistics, const State& state, const Job& job, FrameResult& frame_result,
                  const std::string& why) {
  const engine::Device& first = state.devices.first();
  const auto stage = [&](const char* name) {
    const auto found = frame_result.stage_seconds.find(name);
    return found == frame_result.stage_seconds.end() ? 0.0 : found->second;
  };
  Statistics::Seconds& seconds = statistics.seconds;
  record_preparations(statistics, state.devices);
  seconds.render = frame_result.render_seconds;
  seconds.trace = stage("trace_closest") + stage("trace_shadow");
  seconds.shade = stage("shade");
  seconds.admit = stage("admit");
  seconds.add = stage("add");
  seconds.divide = frame_result.divide_seconds;
  seconds.route.reset();
  if (frame_result.division.odprt) seconds.route = stage("route");
  statistics.rays = rays_told(frame_result.counters);
  statistics.mrays_per_s = mrays_per_s(frame_result.counters.total(), frame_result.render_seconds);
  statistics.features = features_told(job.features);
  statistics.frame = {job.frame.width, job.frame.height, job.frame.n_samples, job.frame.max_depth,
                      job.frame.spawn_threshold};
  statistics.samples = samples_told(job.frame, frame_result.samples);
  statistics.ledger = checkpoint_told(job);
  statistics.memory.frame_bytes = frame_result.frame_bytes;
  statistics.memory.per_queue = std::move(frame_result.memory_of_queues);
  add_devices(frame_result.division, state.devices);
  const std::size_t n_queues =
      state.ranks ? frame_result.division.per_queue.size() : state.devices.n_queues();
  frame_result.division.why = why;
  const Traversal traversal =
      traversal_in(job.options.precision, job.options.traversal, first.context.info());
  statistics.mode = {.name = frame_result.division.odprt ? "odprt" : "pdprt",
                     .queues = n_queues,
                     .work_group = first.work_group,
                     .traversal = name_of(traversal),
                     .precision = name_of(job.options.precision),
                     .division = std::move(frame_result.division),
                     .repeat = {}};
}

void record_query(Statistics& statistics, const engine::DeviceScene& devices, const Query& query) {
  record_preparations(statistics, devices);
  statistics.seconds.trace = query.seconds;
  statistics.rays = {.total = query.rays, .kinds = {}};
  statistics.mrays_per_s = mrays_per_s(query.rays, query.seconds);
  std::size_t n_places = 0;
  for (const engine::Device& device : devices) n_places += device.context.n_sub_devices();
  statistics.mode = {.name = "query",
                     .queues = n_places,
                     .work_group = devices.first().work_group,
                     .traversal = name_of(query.traversal),
                     .precision = name_of(query.precision),
                     .division = {},
                     .repeat = query.repeat};
}

const char* name_of(Traversal traversal) {
  switch (traversal) {
    case Traversal::automatic:
      return "auto";
    case Traversal::binary:
      return "binary";
    case Traversal::wide:
      return "wide";
    case Traversal::packet:
      return "packet";
    case Traversal::batch:
      return "batch";
  }
  return "?";
}

const char* name_of(Precision precision) {
  return precision == Precision::float64 ? "double" : "float";
}

const char* name_of(Division division) {
  switch (division) {
    case Division::bag:
      return "bag";
    case Division::contiguous:
      return "contiguous";
    case Division::interleaved:
      return "interleaved";
  }
  return "?";
}

const char* name_of(Balance balance) {
  switch (balance) {
    case Balance::sah:
      return "sah";
    case Balance::pilot:
      return "pilot";
    case Balance::dynamic:
      return "dynamic";
  }
  return "?";
}

}  // namespace kdray::api
