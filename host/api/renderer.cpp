#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>

#include "api/choose_mode.h"
#include "api/draw.h"
#include "api/hooks.h"
#include "api/job.h"
#include "api/open_devices.h"
#include "api/precision.h"
#include "api/record.h"
#include "api/state.h"

#include "accel/prepare/instanced.h"
#include "base/timeline.h"
#include "base/timer.h"
#include "engine/query/trace.h"
#include "kdray/kdray.h"

namespace kdray {

namespace {

Picture to_picture(const RenderOptions& resolved, api::FrameResult& result,
                   std::vector<image::Channel> channels) {
  const PixelRect part = resolved.crop.value_or(PixelRect{});
  Picture picture{.width = static_cast<int>(result.width),
                  .height = static_cast<int>(result.height),
                  .rgb = std::move(result.rgb),
                  .channels = {},
                  .warnings = std::move(result.warnings),
                  .x = part.x,
                  .y = part.y,
                  .whole_width = resolved.width,
                  .whole_height = resolved.height};
  for (image::Channel& c : channels) picture.channels.push_back({std::move(c.name), std::move(c.values)});
  return picture;
}

// Times what is done on the way to a frame or a query, beside what the statistics tell of by other names.
class Preparing {
 public:
  explicit Preparing(const engine::DeviceScene& devices) : devices_(devices), before_(told()) {}

  // `work`: the frame or the query itself.
  double beside(double work) const { return std::max(0.0, timer_.seconds() - work - (told() - before_)); }

 private:
  double told() const { return devices_.build_seconds() + devices_.upload_seconds(); }

  const engine::DeviceScene& devices_;
  double before_;
  Timer timer_;
};

}  // namespace

struct Renderer::Impl {
  Impl(std::shared_ptr<engine::DeviceScene> devices, const api::Hooks& hooks)
      : state(std::move(devices), hooks), statistics(api::first_statistics(state.devices)) {}
  Impl(const PreparedScene& prepared, const DeviceOptions& options, const api::Hooks& hooks)
      : Impl(api::open_scene(prepared.prepared(), options, hooks), hooks) {}

  Picture render(const RenderOptions& options);
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal wanted,
                         Precision precision, std::vector<std::uint32_t>* instances);
  void tune(const Tuning& tuning);
  void look(const prepare::Prepared& seen);

  api::State state;
  Statistics statistics;
  std::string timeline;  // of the last frame, where it was asked for
};

void Renderer::Impl::tune(const Tuning& tuning) {
  state.devices.tune(tuning);
  state.scheduler.forget();
  statistics.tuning = api::tuning_told(state.devices.first().tuned());
}

// The trees and primitives of `seen` are this scene's own.
void Renderer::Impl::look(const prepare::Prepared& seen) {
  state.devices.look(seen);
  if (state.divided) state.divided->light(seen.flat);
}

Picture Renderer::Impl::render(const RenderOptions& options) {
  timeline::Timeline kept;
  api::Job job = api::make_job(state, options, options.timeline ? &kept : nullptr);
  const bool leads = !state.ranks || state.ranks->leads();
  if (options.ledger && leads) api::open_checkpoint(state, job);
  api::ChosenMode chosen = api::choose_mode(state, job);
  if (state.ranks) chosen.mode = api::agree(state, job, chosen.mode);
  const Preparing preparing(state.devices);
  api::FrameResult frame_result =
      chosen.mode == Mode::odprt ? api::draw_odprt(state, job) : api::draw_pdprt(state, job);
  timeline = options.timeline ? kept.json() : std::string();
  statistics.seconds.prepare =
      preparing.beside(frame_result.render_seconds + frame_result.divide_seconds.value_or(0));
  api::record_frame(statistics, state, job, frame_result, chosen.why);
  if (job.checkpoint)
    std::ranges::copy(job.checkpoint->warnings(), std::back_inserter(frame_result.warnings));
  if (!leads) return {};
  std::vector<image::Channel> channels = api::channels_of(state, job, frame_result);
  return to_picture(job.options, frame_result, std::move(channels));
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal wanted,
                                       Precision precision, std::vector<std::uint32_t>* instances) {
  const Traversal traversal = api::traversal_of_rays(precision, wanted, state.devices);
  const Preparing preparing(state.devices);
  const std::vector<query::Target> targets = query::targets_of(state.devices, traversal, precision);
  query::Traced result = query::trace(targets, rays, {.any_hit = any_hit, .repeat = repeat});
  statistics.seconds.prepare =
      preparing.beside(std::accumulate(result.seconds.begin(), result.seconds.end(), 0.0));
  api::record_query(statistics, state.devices,
                    {.rays = rays.size(),
                     .repeat = result.seconds.size(),
                     .seconds = median(result.seconds),
                     .traversal = targets.front().walk(),
                     .precision = precision});
  if (instances) *instances = std::move(result.instances);
  return std::move(result.hits);
}

namespace {

// The device first: without one there is no use in building a tree.
PreparedScene prepared_for(const DeviceOptions& device, const api::Hooks& hooks, const Scene& scene,
                           const TreeOptions& tree) {
  api::open_device(device, hooks);
  return PreparedScene(scene, tree);
}

}  // namespace

Renderer::Renderer(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device)
    : Renderer(prepared_for(device, {}, scene, tree), device) {}
Renderer::Renderer(const PreparedScene& scene, const DeviceOptions& device)
    : Renderer(std::make_unique<Impl>(scene, device, api::Hooks())) {}
Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() {
  if (device::is_forked_off()) static_cast<void>(impl_.release());  // it holds OpenCL's objects
}

Picture Renderer::render(const RenderOptions& options) {
  device::refuse_after_fork();
  return impl_->render(options);
}
std::vector<Hit> Renderer::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal,
                                 Precision precision, std::vector<std::uint32_t>* instances) {
  device::refuse_after_fork();
  return impl_->trace(rays, any_hit, repeat, traversal, precision, instances);
}
void Renderer::look(const PreparedScene& seen) {
  impl_->look(seen.prepared());
}
void Renderer::tune(const Tuning& tuning) {
  impl_->tune(tuning);
}
std::string Renderer::timeline() const {
  return impl_->timeline;
}
const Statistics& Renderer::statistics() const {
  return impl_->statistics;
}

namespace api {

struct HookedRenderer {
  static Renderer make(const PreparedScene& scene, const DeviceOptions& device, const Hooks& hooks) {
    return Renderer(std::make_unique<Renderer::Impl>(scene, device, hooks));
  }
  static Renderer make(std::shared_ptr<engine::DeviceScene> devices) {
    return Renderer(std::make_unique<Renderer::Impl>(std::move(devices), Hooks()));
  }
  static void keep(Renderer& renderer, std::uint64_t bits) { renderer.impl_->state.keep = bits; }
};

Renderer make_renderer(std::shared_ptr<engine::DeviceScene> devices) {
  return HookedRenderer::make(std::move(devices));
}
Renderer make_renderer(const PreparedScene& scene, const DeviceOptions& device, const Hooks& hooks) {
  return HookedRenderer::make(scene, device, hooks);
}
Renderer make_renderer(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device,
                       const Hooks& hooks) {
  return HookedRenderer::make(prepared_for(device, hooks, scene, tree), device, hooks);
}
void keep(Renderer& renderer, std::uint64_t bits) {
  HookedRenderer::keep(renderer, bits);
}

}  // namespace api

}  // namespace kdray
