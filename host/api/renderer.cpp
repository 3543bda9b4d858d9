#include <algorithm>
#include <cmath>

#include "base/timer.h"
#include "flatten/features.h"
#include "flatten/frame.h"
#include "kdray/kdray.h"
#include "odprt_mode.h"
#include "pdprt/render.h"
#include "prepare/prepared.h"
#include "statistics.h"
#include "wavefront/channels.h"
#include "wavefront/query.h"

namespace kdray {

namespace {

constexpr std::size_t kDefaultWorkGroup = 64;

const char* traversal_name(Traversal traversal) {
  switch (traversal) {
    case Traversal::binary:
      return "binary";
    case Traversal::wide:
      return "wide";
    case Traversal::packet:
      return "packet";
    case Traversal::batch:
      return "batch";
    default:
      return "auto";
  }
}

void check(const DeviceOptions& o) {
  if (o.queues < 1 || o.queues > 1024) throw Error(ErrorCode::usage, "the number of queues may be 1 to 1024");
  if (o.work_group < 0) throw Error(ErrorCode::usage, "the work-group size may not be negative");
  if (o.compute_units < 0) throw Error(ErrorCode::usage, "the number of compute units may not be negative");
}

device::Context open(const DeviceOptions& o) {
  check(o);
  return device::Context(o.device, o.queues, o.compute_units);
}

std::size_t work_group_of(const DeviceOptions& o, const device::Context& context) {
  const std::size_t largest = context.max_work_group();
  if (static_cast<std::size_t>(o.work_group) > largest)
    throw Error(ErrorCode::usage, "the work-group size is " + std::to_string(o.work_group) +
                                      "; this device takes " + std::to_string(largest) + " at most");
  return o.work_group > 0 ? static_cast<std::size_t>(o.work_group)
                          : std::min<std::size_t>(kDefaultWorkGroup, largest);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double mrays_per_s(std::uint64_t rays, double seconds) {
  return seconds > 0 ? static_cast<double>(rays) / seconds * 1e-6 : 0.0;
}

Picture to_picture(const film::Image& image, std::vector<film::Channel> channels) {
  Picture picture{image.width, image.height, {}, {}};
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
  Impl(const PreparedScene& scene, const DeviceOptions& device);

  Picture render(const RenderOptions& options);
  Picture render_odprt(layout::Frame frame, const RenderOptions& options, std::uint32_t features);
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal);
  wavefront::Schedule schedule_for(const layout::Frame& frame, const RenderOptions& options) const;
  void record_odprt(const odprt::Result& result, const layout::Frame& frame, const RenderOptions& options,
                    std::uint32_t features);
  void record(const pdprt::Result& result, const layout::Frame& frame, std::uint32_t features,
              Traversal traversal);

  prepare::Prepared scene;  // but for its arrays, which are on the device
  device::Context context;
  const DeviceOptions device_options;
  std::size_t work_group;
  std::unique_ptr<wavefront::SceneBuffers> buffers;
  std::unique_ptr<wavefront::Programs> programs;
  std::unique_ptr<odprt::DividedScene> divided;
  api::Json statistics;
  std::string timeline;  // of the last frame, where it was asked for
};

Renderer::Impl::Impl(const PreparedScene& prepared, const DeviceOptions& options)
    : scene(prepared.prepared()),
      context(open(options)),
      device_options(options),
      work_group(work_group_of(options, context)) {
  const Timer timer;
  buffers = std::make_unique<wavefront::SceneBuffers>(context, scene.flat, scene.wide);
  statistics["seconds"] = {{"build", scene.seconds.build},
                           {"flatten", scene.seconds.flatten},
                           {"upload", timer.seconds()},
                           {"compile", 0.0}};
  programs = std::make_unique<wavefront::Programs>(context, scene.tree_depth, scene.wide);
  statistics["scene"] = api::scene_json(scene);
  statistics["tree"] = api::tree_json(scene);
  statistics["memory"] = {{"scene_bytes", scene.bytes()}};
  statistics["device"] = api::device_json(context.info());
  statistics["features"] = api::features_json(scene.features);
}

// Slices enough to keep every lane of a launch busy, but no more than the picture has tiles.
wavefront::Schedule Renderer::Impl::schedule_for(const layout::Frame& frame,
                                                 const RenderOptions& options) const {
  wavefront::Schedule schedule;
  if (options.tile_width > 0) schedule.tile_width = static_cast<std::uint32_t>(options.tile_width);
  if (options.tile_height > 0) schedule.tile_height = static_cast<std::uint32_t>(options.tile_height);
  // A slice counts the samples of its tile in 32 bits.
  const double tile_samples = static_cast<double>(std::min(schedule.tile_width, frame.width)) *
                              std::min(schedule.tile_height, frame.height) * frame.n_samples;
  if (tile_samples > 0xffffffff)
    throw Error(ErrorCode::usage, "a tile holds over 2^32 samples; take smaller tiles (--tile)");
  schedule.work_group = work_group;
  const std::uint64_t tiles_x = (frame.width + schedule.tile_width - 1) / schedule.tile_width;
  const std::uint64_t tiles_y = (frame.height + schedule.tile_height - 1) / schedule.tile_height;
  // Enough slices that the last ones to end leave no core idle for long; each has a pool and streams of its own.
  const std::uint64_t slices = std::max<std::uint64_t>(schedule.n_slices, 16 * context.info().compute_units);
  schedule.n_slices = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(tiles_x * tiles_y, 1, slices));
  schedule.traversal = options.traversal;
  schedule.fused = context.info().kind == "cpu";
  return schedule;
}

void Renderer::Impl::record(const pdprt::Result& result, const layout::Frame& frame, std::uint32_t used,
                            Traversal traversal) {
  api::Json& seconds = statistics["seconds"];
  const auto stage = [&](const char* name) {
    const auto found = result.stage_seconds.find(name);
    return found == result.stage_seconds.end() ? 0.0 : found->second;
  };
  seconds["compile"] = programs->build_seconds();
  seconds["render"] = result.render_seconds;
  seconds["trace"] = stage("trace_closest") + stage("trace_shadow");
  seconds["shade"] = stage("shade");
  seconds["admit"] = stage("admit");
  seconds["add"] = stage("add");
  statistics["rays"] = api::rays_json(result.counters);
  statistics["mrays_per_s"] = mrays_per_s(result.counters.total(), result.render_seconds);
  statistics["memory"]["frame_bytes"] = result.device_bytes;
  statistics["features"] = api::features_json(used);
  statistics["mode"] = {{"name", "pdprt"},
                        {"queues", context.queues().size()},
                        {"sub_devices", context.n_sub_devices()},
                        {"traversal", traversal_name(traversal)},
                        {"precision", "float"},
                        {"work_group", work_group},
                        {"programs", programs->n_built()},
                        {"waves", result.counters.waves},
                        {"bands", result.n_bands}};
  statistics["frame"] = {{"width", frame.width},
                         {"height", frame.height},
                         {"samples", frame.n_samples},
                         {"depth", frame.max_depth},
                         {"spawn_threshold", frame.spawn_threshold}};
}

Picture Renderer::Impl::render(const RenderOptions& options) {
  const RenderOptions o = flatten::resolved(options, scene.settings.settings);
  const layout::Frame frame = flatten::make_frame(scene.settings, scene.geometry, o);
  const std::uint32_t used = scene.features | flatten::features_of_samples(o.samples);
  if (o.mode == Mode::odprt) return render_odprt(frame, o, used);
  const pdprt::Result result =
      pdprt::render(context, *buffers, *programs, frame, schedule_for(frame, o), used, o.progress);
  record(result, frame, used, options.traversal);
  return to_picture(result.image,
                    wavefront::render_channels(context, *buffers, *programs, frame, used, o.channels));
}

void Renderer::Impl::record_odprt(const odprt::Result& result, const layout::Frame& frame,
                                  const RenderOptions& options, std::uint32_t used) {
  api::Json& seconds = statistics["seconds"];
  for (const auto& [stage, time] : result.stage_seconds) seconds[stage] = time;
  seconds["compile"] = programs->build_seconds();
  seconds["render"] = result.render_seconds;
  seconds["divide"] = result.divide_seconds;
  statistics["rays"] = api::rays_json(result.counters);
  statistics["mrays_per_s"] = mrays_per_s(result.counters.total(), result.render_seconds);
  statistics["memory"]["per_queue"] = api::odprt_memory_json(result);
  statistics["features"] = api::features_json(used);
  statistics["mode"] = api::odprt_mode_json(result, options, divided->geometry_bytes());
  statistics["mode"]["queues"] = context.queues().size();
  statistics["mode"]["traversal"] = traversal_name(options.traversal);
  statistics["frame"] = {{"width", frame.width}, {"height", frame.height}};
}

Picture Renderer::Impl::render_odprt(layout::Frame frame, const RenderOptions& o, std::uint32_t used) {
  const wavefront::Schedule schedule = schedule_for(frame, o);
  schedule.apply(frame, used);
  if (!divided) divided = std::make_unique<odprt::DividedScene>(scene.flat, scene.wide);
  timeline::Timeline rows;
  device::Faults faults(device_options.faults);
  odprt::Request request;
  for (const cl::CommandQueue& queue : context.queues())
    request.queues.push_back({&context, queue, programs.get(), request.queues.size()});
  request.frame = frame;
  request.features = used;
  request.traversal = api::odprt_traversal(o.traversal);
  request.balance = o.balance;
  request.ray_buffer = static_cast<std::uint32_t>(o.ray_buffer);
  request.device_memory = o.device_memory;
  request.timeline = o.timeline ? &rows : nullptr;
  request.faults = &faults;
  request.progress = o.progress;
  odprt::Result result = divided->render(request);
  timeline = o.timeline ? rows.json() : "";
  record_odprt(result, frame, o, used);
  return to_picture(result.image, {});
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat,
                                       Traversal wanted) {
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  const Traversal traversal =
      wanted == Traversal::automatic && context.info().kind != "cpu" ? Traversal::wide : wanted;
  wavefront::QueryResult result =
      wavefront::trace_query(context, *buffers, *programs, scene.geometry, scene.features, work_group,
                             traversal, rays, any_hit, repeat);
  const double seconds = median(result.seconds);
  statistics["seconds"]["compile"] = programs->build_seconds();
  statistics["seconds"]["trace"] = seconds;
  statistics["rays"] = {{"total", rays.size()}};
  statistics["mrays_per_s"] = mrays_per_s(rays.size(), seconds);
  statistics["mode"] = {{"name", "query"},
                        {"queues", 1},
                        {"traversal", traversal_name(traversal)},
                        {"precision", "float"},
                        {"work_group", work_group},
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
std::vector<Hit> Renderer::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal) {
  return impl_->trace(rays, any_hit, repeat, traversal);
}
std::string Renderer::timeline() const {
  return impl_->timeline;
}
std::string Renderer::statistics() const {
  return impl_->statistics.dump(2);
}

void open_device(const DeviceOptions& options) {
  const device::Context context = open(options);
  work_group_of(options, context);
}

}  // namespace kdray
