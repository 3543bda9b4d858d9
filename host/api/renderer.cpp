#include <span>

#include "api/channels.h"
#include "api/choose_mode.h"
#include "api/draw_odprt.h"
#include "api/draw_pdprt.h"
#include "api/job.h"
#include "api/names.h"
#include "api/precision.h"
#include "api/state.h"
#include "api/statistics.h"
#include "base/median.h"
#include "kdray/kdray.h"
#include "timeline/timeline.h"
#include "wavefront/query.h"

namespace kdray {

namespace {

Picture to_picture(const film::Image& image, std::vector<film::Channel> channels) {
  Picture picture{image.width, image.height, {}, {}, {}};
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  if (!image.pixels.empty()) {
    const float* const first = &image.pixels.front().x;
    picture.rgb.assign(first, first + 3 * image.pixels.size());
  }
  for (film::Channel& c : channels) picture.channels.push_back({std::move(c.name), std::move(c.values)});
  return picture;
}

}  // namespace

struct Renderer::Impl {
  Impl(const PreparedScene& prepared, const DeviceOptions& device_options);

  Picture render(const RenderOptions& options);
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal wanted,
                         Precision precision);
  void tune(const Tuning& tuning);
  void record_seconds();
  void record_frame(const api::Job& job, const api::Drawn& drawn);
  void record_mode(const api::Job& job, api::Json mode, const std::string& why);

  api::State state;
  api::Json statistics;
  std::string timeline;  // of the last frame, where it was asked for
};

Renderer::Impl::Impl(const PreparedScene& prepared, const DeviceOptions& device_options)
    : state(prepared.prepared(), device_options) {
  const prepare::Prepared& scene = state.scene;
  const api::Device& first = state.devices.first();
  statistics["seconds"] = {
      {"build", scene.seconds.build}, {"flatten", scene.seconds.flatten}, {"upload", 0.0}, {"compile", 0.0}};
  statistics["scene"] = api::scene_json(scene);
  statistics["tree"] = api::tree_json(scene);
  statistics["memory"] = {{"scene_bytes", state.scene_bytes}};
  statistics["device"] = api::device_json(first.context.info());
  statistics["device"]["tuning"] = api::tuning_json(first.tuned);
  statistics["features"] = api::features_json(scene.features);
}

void Renderer::Impl::tune(const Tuning& tuning) {
  state.devices.tune(tuning);
  state.scheduler.forget();
  statistics["device"]["tuning"] = api::tuning_json(state.devices.first().tuned);
}

void Renderer::Impl::record_seconds() {
  statistics["seconds"]["compile"] = state.devices.build_seconds();
  statistics["seconds"]["upload"] = state.devices.upload_seconds();
}

// What all modes tell of a frame.
void Renderer::Impl::record_frame(const api::Job& job, const api::Drawn& drawn) {
  record_seconds();
  api::Json& seconds = statistics["seconds"];
  const auto stage = [&](const char* name) {
    const auto found = drawn.stage_seconds.find(name);
    return found == drawn.stage_seconds.end() ? 0.0 : found->second;
  };
  seconds["render"] = drawn.render_seconds;
  seconds["trace"] = stage("trace_closest") + stage("trace_shadow");
  seconds["shade"] = stage("shade");
  seconds["admit"] = stage("admit");
  seconds["add"] = stage("add");
  seconds.update(drawn.seconds);
  statistics["rays"] = api::rays_json(drawn.counters);
  statistics["mrays_per_s"] = api::mrays_per_s(drawn.counters.total(), drawn.render_seconds);
  statistics["features"] = api::features_json(job.features);
  statistics["frame"] = {{"width", job.frame.width},
                         {"height", job.frame.height},
                         {"samples", job.frame.n_samples},
                         {"depth", job.frame.max_depth},
                         {"spawn_threshold", job.frame.spawn_threshold}};
  statistics["memory"].update(drawn.memory);
  statistics["samples"] = api::samples_json(job.frame, drawn.samples ? &*drawn.samples : nullptr);
}

// `mode`: what is the mode's own.
void Renderer::Impl::record_mode(const api::Job& job, api::Json mode, const std::string& why) {
  const api::Device& first = state.devices.first();
  std::size_t sub_devices = 0, programs = 0;
  api::Json names = api::Json::array();
  for (const api::Device& d : state.devices) {
    sub_devices += d.context.n_sub_devices();
    programs += d.programs.n_built();
    names.push_back(d.context.info().name);
  }
  mode["why"] = why;
  mode["devices"] = std::move(names);
  mode["sub_devices"] = sub_devices;
  mode["traversal"] =
      api::name_of(api::traversal_in(job.options.precision, job.options.traversal, first.context.info()));
  mode["precision"] = api::name_of(job.options.precision);
  mode["work_group"] = first.work_group;
  mode["programs"] = programs;
  mode["programs_known"] = state.devices.size() * wavefront::Programs::n_known();
  statistics["mode"] = std::move(mode);
}

Picture Renderer::Impl::render(const RenderOptions& options) {
  timeline::Timeline kept;
  api::Job job = api::make_job(state, options, options.timeline ? &kept : nullptr);
  const api::ChosenMode chosen = api::choose_mode(state, job);
  api::Drawn drawn = chosen.mode == Mode::odprt ? api::draw_odprt(state, job) : api::draw_pdprt(state, job);
  timeline = options.timeline ? kept.json() : std::string();
  record_frame(job, drawn);
  record_mode(job, std::move(drawn.mode), chosen.why);
  Picture picture = to_picture(drawn.image, api::channels_of(state, job, drawn));
  picture.warnings = std::move(drawn.warnings);
  return picture;
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal wanted,
                                       Precision precision) {
  api::Device& first = state.devices.first();
  Traversal traversal = api::traversal_in(precision, wanted, first.context.info());
  api::check_form(takes_binary_form(traversal, precision), state.scene);
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  if (traversal == Traversal::automatic && first.global) traversal = Traversal::wide;
  wavefront::QueryResult result =
      wavefront::trace_query(first.context, first.buffers(), first.programs, state.scene.geometry,
                             state.scene.features, first.work_group, traversal, precision, rays, any_hit,
                             repeat, first.global ? wavefront::kBoundedLaunch : wavefront::kRaysPerChunk);
  const double seconds = median(result.seconds);
  record_seconds();
  statistics["seconds"]["trace"] = seconds;
  statistics["rays"] = {{"total", rays.size()}};
  statistics["mrays_per_s"] = api::mrays_per_s(rays.size(), seconds);
  statistics["mode"] = {{"name", "query"},
                        {"queues", 1},
                        {"traversal", api::name_of(traversal)},
                        {"precision", api::name_of(precision)},
                        {"work_group", first.work_group},
                        {"repeat", result.seconds.size()}};
  return std::move(result.hits);
}

namespace {

// The device first: without one there is no use in building a tree.
PreparedScene prepared_for(const DeviceOptions& device, const Scene& scene, const TreeOptions& tree) {
  open_device(device);
  return PreparedScene(scene, tree);
}

}  // namespace

Renderer::Renderer(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device)
    : Renderer(prepared_for(device, scene, tree), device) {}
Renderer::Renderer(const PreparedScene& scene, const DeviceOptions& device)
    : impl_(std::make_unique<Impl>(scene, device)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Picture Renderer::render(const RenderOptions& options) {
  return impl_->render(options);
}
std::vector<Hit> Renderer::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal,
                                 Precision precision) {
  return impl_->trace(rays, any_hit, repeat, traversal, precision);
}
void Renderer::tune(const Tuning& tuning) {
  impl_->tune(tuning);
}
std::string Renderer::timeline() const {
  return impl_->timeline;
}
std::string Renderer::statistics() const {
  return impl_->statistics.dump(2);
}

}  // namespace kdray
