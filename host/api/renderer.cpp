#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/timer.h"
#include "device/faults.h"
#include "flatten/features.h"
#include "flatten/frame.h"
#include "kdray/kdray.h"
#include "odprt_mode.h"
#include "pdprt/render.h"
#include "prepare/prepared.h"
#include "statistics.h"
#include "timeline/timeline.h"
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

std::vector<device::Context> open(const DeviceOptions& o) {
  check(o);
  return device::open_contexts(o.device, o.queues, o.compute_units);
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

const char* division_name(Division division) {
  switch (division) {
    case Division::contiguous:
      return "contiguous";
    case Division::interleaved:
      return "interleaved";
    default:
      return "bag";
  }
}

// A device, and the whole scene on it once it is wanted there.
class Device {
 public:
  Device(const device::Context& opened, const DeviceOptions& o, const prepare::Prepared& scene)
      : context(opened),
        work_group(work_group_of(o, context)),
        programs(context, scene.tree_depth, scene.wide),
        scene_(scene) {}

  const wavefront::SceneBuffers& buffers() {
    if (!buffers_) {
      const Timer timer;
      buffers_.emplace(context, scene_.flat, scene_.wide);
      upload_seconds = timer.seconds();
    }
    return *buffers_;
  }

  device::Context context;
  std::size_t work_group;
  wavefront::Programs programs;
  double upload_seconds = 0;

 private:
  const prepare::Prepared& scene_;
  std::optional<wavefront::SceneBuffers> buffers_;
};

// A frame that is to be rendered, whatever the mode.
struct Job {
  RenderOptions options;  // resolved
  layout::Frame frame;
  std::uint32_t features;
  timeline::Timeline* timeline;  // null: not wanted
};

// Mrays/s of the last frames of one size, by mode; 0: not measured.
struct Speeds {
  std::uint32_t width = 0, height = 0;
  double pdprt = 0, odprt = 0;

  Speeds& take(const layout::Frame& frame) {
    if (width != frame.width || height != frame.height) *this = {frame.width, frame.height, 0, 0};
    return *this;
  }
};

struct Chosen {
  Mode mode;
  std::string why;
};

struct Drawn {
  film::Image image;
  std::vector<std::string> warnings;
};

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
  Impl(const PreparedScene& scene, const DeviceOptions& device);

  Picture render(const RenderOptions& options);
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal);

  Device& first() { return *devices.front(); }
  std::size_t n_queues() const;  // of all devices
  double build_seconds() const;
  double upload_seconds() const;
  void choose_tiles(wavefront::Schedule& schedule, const Job& job) const;
  wavefront::Schedule schedule_for(const Device& device, const Job& job) const;
  Chosen choose_mode(const Job& job) const;
  Drawn draw_pdprt(const Job& job, const std::string& why);
  Drawn draw_odprt(Job& job, const std::string& why);
  void record_frame(const Job& job, const wavefront::Counters& counters,
                    const std::map<std::string, double>& stage_seconds, double render_seconds);
  void record_mode(const Job& job, api::Json mode, const std::string& why);

  prepare::Prepared scene;
  std::size_t scene_bytes;                       // of its arrays, on a device that has all of it
  std::vector<std::unique_ptr<Device>> devices;  // queries and channels take the first
  device::Faults faults;
  std::unique_ptr<odprt::DividedScene> divided;  // once a frame was rendered in ODPRT
  std::uint32_t n_units = 0;                     // compute units of all devices
  struct {
    std::uint32_t width = 0, height = 0;
    pdprt::TileCost cost;
  } last_frame;  // what its tiles cost
  Speeds speeds;
  api::Json statistics;
  std::string timeline;  // of the last frame, where it was asked for
};

Renderer::Impl::Impl(const PreparedScene& prepared, const DeviceOptions& device_options)
    : scene(prepared.prepared()), scene_bytes(scene.bytes()), faults(device_options.faults) {
  const std::vector<device::Context> contexts = open(device_options);
  for (const device::Context& context : contexts) {
    devices.push_back(std::make_unique<Device>(context, device_options, scene));
    n_units += context.info().compute_units;
  }
  statistics["seconds"] = {
      {"build", scene.seconds.build}, {"flatten", scene.seconds.flatten}, {"upload", 0.0}, {"compile", 0.0}};
  statistics["scene"] = api::scene_json(scene);
  statistics["tree"] = api::tree_json(scene);
  statistics["memory"] = {{"scene_bytes", scene_bytes}};
  statistics["device"] = api::device_json(first().context.info());
  statistics["features"] = api::features_json(scene.features);
}

std::size_t Renderer::Impl::n_queues() const {
  std::size_t n = 0;
  for (const auto& device : devices) n += device->context.queues().size();
  return n;
}

double Renderer::Impl::build_seconds() const {
  double seconds = 0;
  for (const auto& device : devices) seconds += device->programs.build_seconds();
  return seconds;
}

double Renderer::Impl::upload_seconds() const {
  double seconds = 0;
  for (const auto& device : devices) seconds += device->upload_seconds;
  return seconds;
}

// What was asked for, else by what the last frame of this size told.
void Renderer::Impl::choose_tiles(wavefront::Schedule& schedule, const Job& job) const {
  const layout::Frame& frame = job.frame;
  const RenderOptions& o = job.options;
  std::optional<pdprt::TileCost> measured;
  if (last_frame.width == frame.width && last_frame.height == frame.height && last_frame.cost.total > 0)
    measured = last_frame.cost;
  const std::uint32_t units = std::max(n_units, static_cast<std::uint32_t>(n_queues()));
  const std::uint32_t side = pdprt::choose_tile_side(frame.width, frame.height, units, measured);
  schedule.tile_width = o.tile_width > 0 ? static_cast<std::uint32_t>(o.tile_width) : side;
  schedule.tile_height = o.tile_height > 0 ? static_cast<std::uint32_t>(o.tile_height) : side;
  // A slice counts the samples of its tile in 32 bits.
  const double tile_samples = static_cast<double>(std::min(schedule.tile_width, frame.width)) *
                              std::min(schedule.tile_height, frame.height) * frame.n_samples;
  if (tile_samples > 0xffffffff)
    throw Error(ErrorCode::usage, "a tile holds over 2^32 samples; take smaller tiles (--tile)");
}

wavefront::Schedule Renderer::Impl::schedule_for(const Device& device, const Job& job) const {
  wavefront::Schedule schedule;
  choose_tiles(schedule, job);
  schedule.work_group = device.work_group;
  schedule.traversal = job.options.traversal;
  schedule.fused = device.context.info().kind == "cpu";
  // Enough slices that the last ones to end leave no core idle for long; each has a pool and streams of its own.
  const auto n_parts = static_cast<std::uint32_t>(device.context.n_sub_devices());
  const std::uint32_t units = (device.context.info().compute_units + n_parts - 1) / n_parts;  // of a queue
  schedule.n_slices = std::max(schedule.n_slices, 16 * units);
  if (schedule.fused && n_queues() > 1) {
    // Launches that do less, so that what a queue must have ahead of it (pdprt/queue.h) is little. On one core slices
    // would only take turns.
    schedule.n_slices = units == 1 ? 1 : 16 * units;
    schedule.fused_waves = units == 1 ? 128 : 32;
  }
  const std::uint64_t tiles_x = (job.frame.width + schedule.tile_width - 1) / schedule.tile_width;
  const std::uint64_t tiles_y = (job.frame.height + schedule.tile_height - 1) / schedule.tile_height;
  // No more than the picture has tiles.
  schedule.n_slices =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(tiles_x * tiles_y, schedule.n_slices));
  return schedule;
}

// By what fits; by what was measured, where this Renderer has rendered such a frame in both modes.
Chosen Renderer::Impl::choose_mode(const Job& job) const {
  if (job.options.mode != Mode::automatic) return {job.options.mode, "asked for"};
  const auto megabytes = [](std::uint64_t bytes) { return fmt::format("{}M", (bytes >> 20) + 1); };
  const std::string scene_takes = fmt::format("the scene takes {}", megabytes(scene_bytes));
  if (job.options.device_memory > 0 && scene_bytes > job.options.device_memory)
    return {Mode::odprt,
            fmt::format("{}, more than --device-memory {}", scene_takes, job.options.device_memory)};
  for (const auto& d : devices)
    if (scene_bytes > d->context.info().global_memory)
      return {Mode::odprt, fmt::format("{}, {} has {}", scene_takes, d->context.info().name,
                                       megabytes(d->context.info().global_memory))};
  const Speeds& s = speeds;
  if (s.width == job.frame.width && s.height == job.frame.height && s.odprt > s.pdprt && s.pdprt > 0)
    return {Mode::odprt, fmt::format("measured {:.3g} Mrays/s, pdprt {:.3g}", s.odprt, s.pdprt)};
  return {Mode::pdprt, fmt::format("{} and fits every device whole", scene_takes)};
}

Drawn Renderer::Impl::draw_odprt(Job& job, const std::string& why) {
  const RenderOptions& o = job.options;
  if (o.device_memory > 0 && !o.channels.empty())
    throw Error(ErrorCode::usage, "--aov needs the whole scene on a device; leave --device-memory out");
  wavefront::Schedule schedule = schedule_for(first(), job);
  schedule.apply(job.frame, job.features);
  if (!divided) divided = std::make_unique<odprt::DividedScene>(scene.flat, scene.wide);
  odprt::Request request;
  for (const auto& d : devices) {
    schedule.n_slices = std::max(schedule.n_slices, schedule_for(*d, job).n_slices);
    for (const cl::CommandQueue& queue : d->context.queues())
      request.queues.push_back({&d->context, queue, &d->programs, request.queues.size()});
  }
  request.frame = job.frame;
  request.features = job.features;
  request.traversal = api::odprt_traversal(o.traversal, first().context.info().kind == "cpu");
  request.balance = o.balance;
  request.n_slices = schedule.n_slices;
  request.ray_buffer = static_cast<std::uint32_t>(o.ray_buffer);
  request.device_memory = o.device_memory;
  request.timeline = job.timeline;
  request.faults = &faults;
  request.progress = o.progress;
  odprt::Result result = divided->render(request);
  speeds.take(job.frame).odprt = mrays_per_s(result.counters.total(), result.render_seconds);
  record_frame(job, result.counters, result.stage_seconds, result.render_seconds);
  statistics["seconds"]["divide"] = result.divide_seconds;
  statistics["seconds"]["route"] = result.stage_seconds["route"];
  api::Json mode = api::odprt_mode_json(result, o, divided->geometry_bytes());
  mode["queues"] = n_queues();
  mode["tile"] = {job.frame.tile_width, job.frame.tile_height};
  mode["tiles"] = job.frame.n_tiles;
  record_mode(job, std::move(mode), why);
  statistics["memory"]["per_queue"] = api::odprt_memory_json(result);
  return {std::move(result.image), api::warnings_of(result)};
}

Drawn Renderer::Impl::draw_pdprt(const Job& job, const std::string& why) {
  std::vector<pdprt::Device> places;
  for (const auto& d : devices)
    places.push_back({&d->context, &d->buffers(), &d->programs, schedule_for(*d, job)});
  pdprt::Result result = pdprt::render(places, {.frame = job.frame,
                                                .features = job.features,
                                                .division = job.options.division,
                                                .progress = job.options.progress,
                                                .faults = &faults,
                                                .timeline = job.timeline});
  last_frame = {job.frame.width, job.frame.height, result.tile_cost};
  speeds.take(job.frame).pdprt = mrays_per_s(result.counters.total(), result.render_seconds);
  record_frame(job, result.counters, result.stage_seconds, result.render_seconds);
  api::Json mode = api::pdprt_json(result);
  mode["division"] = division_name(job.options.division);
  record_mode(job, std::move(mode), why);
  statistics["memory"].update(api::pdprt_memory_json(result, scene_bytes));
  return {std::move(result.image), api::warnings_of(result)};
}

// What all modes tell of a frame.
void Renderer::Impl::record_frame(const Job& job, const wavefront::Counters& counters,
                                  const std::map<std::string, double>& stage_seconds, double render_seconds) {
  api::Json& seconds = statistics["seconds"];
  const auto stage = [&](const char* name) {
    const auto found = stage_seconds.find(name);
    return found == stage_seconds.end() ? 0.0 : found->second;
  };
  seconds["compile"] = build_seconds();
  seconds["upload"] = upload_seconds();
  seconds["render"] = render_seconds;
  seconds["trace"] = stage("trace_closest") + stage("trace_shadow");
  seconds["shade"] = stage("shade");
  seconds["admit"] = stage("admit");
  seconds["add"] = stage("add");
  statistics["rays"] = api::rays_json(counters);
  statistics["mrays_per_s"] = mrays_per_s(counters.total(), render_seconds);
  statistics["features"] = api::features_json(job.features);
  statistics["frame"] = {{"width", job.frame.width},
                         {"height", job.frame.height},
                         {"samples", job.frame.n_samples},
                         {"depth", job.frame.max_depth},
                         {"spawn_threshold", job.frame.spawn_threshold}};
}

// `mode`: what is the mode's own.
void Renderer::Impl::record_mode(const Job& job, api::Json mode, const std::string& why) {
  std::size_t sub_devices = 0, programs = 0;
  api::Json names = api::Json::array();
  for (const auto& d : devices) {
    sub_devices += d->context.n_sub_devices();
    programs += d->programs.n_built();
    names.push_back(d->context.info().name);
  }
  mode["why"] = why;
  mode["devices"] = std::move(names);
  mode["sub_devices"] = sub_devices;
  mode["traversal"] = traversal_name(job.options.traversal);
  mode["precision"] = "float";
  mode["work_group"] = first().work_group;
  mode["programs"] = programs;
  statistics["mode"] = std::move(mode);
}

Picture Renderer::Impl::render(const RenderOptions& options) {
  const RenderOptions o = flatten::resolved(options, scene.settings.settings);
  timeline::Timeline kept;
  Job job{.options = o,
          .frame = flatten::make_frame(scene.settings, scene.geometry, o),
          .features = scene.features | flatten::features_of_samples(o.samples),
          .timeline = o.timeline ? &kept : nullptr};
  const Chosen chosen = choose_mode(job);
  Drawn drawn = chosen.mode == Mode::odprt ? draw_odprt(job, chosen.why) : draw_pdprt(job, chosen.why);
  timeline = o.timeline ? kept.json() : std::string();
  Picture picture =
      to_picture(drawn.image, wavefront::render_channels(first().context, first().buffers(), first().programs,
                                                         job.frame, job.features, o.channels));
  picture.warnings = std::move(drawn.warnings);
  return picture;
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat,
                                       Traversal wanted) {
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  const Traversal traversal =
      wanted == Traversal::automatic && first().context.info().kind != "cpu" ? Traversal::wide : wanted;
  wavefront::QueryResult result =
      wavefront::trace_query(first().context, first().buffers(), first().programs, scene.geometry,
                             scene.features, first().work_group, traversal, rays, any_hit, repeat);
  const double seconds = median(result.seconds);
  statistics["seconds"]["compile"] = build_seconds();
  statistics["seconds"]["upload"] = upload_seconds();
  statistics["seconds"]["trace"] = seconds;
  statistics["rays"] = {{"total", rays.size()}};
  statistics["mrays_per_s"] = mrays_per_s(rays.size(), seconds);
  statistics["mode"] = {{"name", "query"},
                        {"queues", 1},
                        {"traversal", traversal_name(traversal)},
                        {"precision", "float"},
                        {"work_group", first().work_group},
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
  for (const device::Context& context : open(options)) work_group_of(options, context);
}

}  // namespace kdray
