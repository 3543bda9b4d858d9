#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/median.h"
#include "base/timer.h"
#include "device/faults.h"
#include "flatten/core.h"
#include "flatten/features.h"
#include "flatten/frame.h"
#include "kdray/kdray.h"
#include "layout/features.h"
#include "odprt_mode.h"
#include "open_devices.h"
#include "pdprt/render.h"
#include "precision.h"
#include "prepare/prepared.h"
#include "statistics.h"
#include "timeline/timeline.h"
#include "tuning.h"
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

std::size_t work_group_of(const DeviceOptions& o, const device::Context& context) {
  const std::size_t largest = context.max_work_group();
  if (static_cast<std::size_t>(o.work_group) > largest)
    throw Error(ErrorCode::usage, "the work-group size is " + std::to_string(o.work_group) +
                                      "; this device takes " + std::to_string(largest) + " at most");
  return o.work_group > 0 ? static_cast<std::size_t>(o.work_group)
                          : std::min<std::size_t>(kDefaultWorkGroup, largest);
}

bool runs_globally(const DeviceOptions& o, const device::Context& context) {
  return o.schedule == Schedule::automatic ? context.info().kind != "cpu" : o.schedule == Schedule::global;
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
        global(runs_globally(o, context)),
        programs(context, scene.tree_depth, scene.wide, o.build_options),
        asked_work_group_(o.work_group),
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
  bool global;  // Schedule::global, asked for or by the kind of device
  wavefront::Programs programs;
  double upload_seconds = 0;
  api::Tuned tuned;

  void use(const api::Tuned& settings) {
    tuned = settings;
    programs.use(tuned.settings);
    const std::size_t own = tuned.settings.work_group > 0
                                ? static_cast<std::size_t>(tuned.settings.work_group)
                                : kDefaultWorkGroup;
    if (asked_work_group_ == 0) work_group = std::min(own, context.max_work_group());
  }

 private:
  int asked_work_group_;  // 0: chosen
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
  std::optional<adaptive::Report> samples;
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
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal,
                         Precision precision);

  Device& first() { return *devices.front(); }
  void tune(const Tuning& tuning);
  std::size_t n_queues() const;  // of all devices
  double build_seconds() const;
  double upload_seconds() const;
  bool has_binary_form() const { return !scene.flat.nodes.empty(); }
  void use_core(Job& job);
  void choose_tiles(wavefront::Schedule& schedule, const Job& job) const;
  wavefront::Schedule schedule_for(const Device& device, const Job& job) const;
  const Device* too_small_for_an_array() const;
  std::optional<std::size_t> pdprt_film_bytes(const Device& device, const Job& job) const;
  std::size_t pdprt_film_bytes(const Job& job) const;
  Chosen choose_mode(const Job& job) const;
  Drawn draw_pdprt(const Job& job, const std::string& why);
  Drawn draw_odprt(Job& job, const std::string& why);
  std::vector<film::Channel> channels(const Job& job, Drawn& drawn);
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
  std::optional<flatten::Core> core;
  api::Json statistics;
  std::string timeline;  // of the last frame, where it was asked for
};

Renderer::Impl::Impl(const PreparedScene& prepared, const DeviceOptions& device_options)
    : scene(prepared.prepared()), scene_bytes(scene.bytes()), faults(device_options.faults) {
  const std::vector<device::Context> contexts = api::open_devices(device_options);
  const tune::Database tunings = api::read_tunings(device_options);
  for (const device::Context& context : contexts) {
    devices.push_back(std::make_unique<Device>(context, device_options, scene));
    Device& made = *devices.back();
    made.use(api::tuned_for(context, made.global, scene.features, tunings, device_options.tunings.string()));
    n_units += context.info().compute_units;
  }
  statistics["seconds"] = {
      {"build", scene.seconds.build}, {"flatten", scene.seconds.flatten}, {"upload", 0.0}, {"compile", 0.0}};
  statistics["scene"] = api::scene_json(scene);
  statistics["tree"] = api::tree_json(scene);
  statistics["memory"] = {{"scene_bytes", scene_bytes}};
  statistics["device"] = api::device_json(first().context.info());
  statistics["device"]["tuning"] = api::tuning_json(first().tuned);
  statistics["features"] = api::features_json(scene.features);
}

void Renderer::Impl::tune(const Tuning& tuning) {
  for (const auto& d : devices)
    d->use({tune::merged(tune::shipped(d->context.info().kind), tuning), d->tuned.key, "given"});
  last_frame = {};
  statistics["device"]["tuning"] = api::tuning_json(first().tuned);
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
  const int tuned = devices.front()->tuned.settings.tile;  // tiles are the frame's, whatever the device
  const std::uint32_t largest = tuned > 0 ? static_cast<std::uint32_t>(tuned) : pdprt::kLargestTile;
  const std::uint32_t side = pdprt::choose_tile_side(frame.width, frame.height, units, measured, largest);
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
  schedule.traversal = api::traversal_in(job.options.precision, job.options.traversal, device.context.info());
  schedule.precision = job.options.precision;
  schedule.fused = !device.global;
  // Enough slices that the last ones to end leave no core idle for long; each has a pool and streams of its
  // own.
  const auto n_parts = static_cast<std::uint32_t>(device.context.n_sub_devices());
  const std::uint32_t units = (device.context.info().compute_units + n_parts - 1) / n_parts;  // of a queue
  schedule.n_slices = std::max(schedule.n_slices, 16 * units);
  if (schedule.fused && n_queues() > 1) {
    // Launches that do less, so that what a queue must have ahead of it (pdprt/queue.h) is little. On one
    // core slices would only take turns.
    schedule.n_slices = units == 1 ? 1 : 16 * units;
    schedule.fused_waves = units == 1 ? 128 : 32;
  }
  const Tuning& tuned = device.tuned.settings;
  if (tuned.batch > 0) schedule.batch_size = static_cast<std::uint32_t>(tuned.batch);
  // Found with a single queue. Several need the rule above.
  if (n_queues() == 1 && tuned.slices > 0)
    schedule.n_slices = static_cast<std::uint32_t>(tuned.slices) * units;
  if (n_queues() == 1 && tuned.waves > 0) schedule.fused_waves = static_cast<std::uint32_t>(tuned.waves);
  const std::uint64_t tiles_x = (job.frame.width + schedule.tile_width - 1) / schedule.tile_width;
  const std::uint64_t tiles_y = (job.frame.height + schedule.tile_height - 1) / schedule.tile_height;
  // No more than the picture has tiles.
  schedule.n_slices =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(tiles_x * tiles_y, schedule.n_slices));
  schedule.fit(job.frame, job.features, device.context.info().max_allocation);
  return schedule;
}

// The device that can't hold one of the scene's arrays in one piece, if there is one.
const Device* Renderer::Impl::too_small_for_an_array() const {
  for (const auto& d : devices)
    if (scene.largest_array() > d->context.info().max_allocation) return d.get();
  return nullptr;
}

// What a queue on the device may have for its film in PDPRT: all that scene and streams leave of
// --device-memory. Nothing where that is less than a row of tiles, or a round of samples, takes.
std::optional<std::size_t> Renderer::Impl::pdprt_film_bytes(const Device& device, const Job& job) const {
  constexpr std::size_t kPlace = 3 * sizeof(layout::i64), kListed = 2 * sizeof(layout::u32);
  const wavefront::Schedule schedule = schedule_for(device, job);
  layout::Frame frame = job.frame;
  schedule.apply(frame, job.features);
  const bool adaptive = job.options.adaptive_target > 0;
  const std::size_t row = std::size_t{frame.tile_height} * frame.width;
  const std::size_t least = (adaptive ? std::max(row, pdprt::kLeastSamples) : row) * kPlace;
  const std::size_t n_queues = device.context.queues().size();
  const std::size_t taken = scene_bytes + n_queues * schedule.stream_bytes(frame);
  if (taken > job.options.device_memory) return std::nullopt;
  std::size_t left = (job.options.device_memory - taken) / n_queues;
  if (adaptive) left = left / (kPlace + kListed) * kPlace;
  return left < least ? std::nullopt : std::optional(left);
}

// Of a queue on any device, for Mode::pdprt. Throws where --device-memory leaves too little.
std::size_t Renderer::Impl::pdprt_film_bytes(const Job& job) const {
  std::size_t bytes = pdprt::Task().max_film_bytes;
  for (const auto& d : devices) {
    bytes = std::min<std::size_t>(bytes, d->context.info().max_allocation);
    if (job.options.device_memory == 0) continue;
    const std::optional<std::size_t> left = pdprt_film_bytes(*d, job);
    if (!left)
      throw Error(
          ErrorCode::out_of_memory,
          fmt::format("--device-memory {} is too little for pdprt, which has the whole scene ({}M) on "
                      "every device; take more, or --mode odprt",
                      job.options.device_memory, (scene_bytes >> 20) + 1));
    bytes = std::min(bytes, *left);
  }
  return bytes;
}

// By what fits; by what was measured, where this Renderer has rendered such a frame in both modes.
Chosen Renderer::Impl::choose_mode(const Job& job) const {
  if (job.options.mode != Mode::automatic) return {job.options.mode, "asked for"};
  if (job.options.precision == Precision::float64) return {Mode::pdprt, "double precision has no other"};
  const auto megabytes = [](std::uint64_t bytes) { return fmt::format("{}M", (bytes >> 20) + 1); };
  const std::string scene_takes = fmt::format("the scene takes {}", megabytes(scene_bytes));
  const auto too_small = [&](const auto& d) { return !pdprt_film_bytes(*d, job); };
  if (job.options.device_memory > 0 && std::ranges::any_of(devices, too_small))
    return {Mode::odprt, fmt::format("{}, with a frame's rays and film more than --device-memory {}",
                                     scene_takes, job.options.device_memory)};
  if (const Device* d = too_small_for_an_array(); d != nullptr && job.options.channels.empty())
    return {Mode::odprt, fmt::format("an array of the scene takes {}, {} gives {} in one piece",
                                     megabytes(scene.largest_array()), d->context.info().name,
                                     megabytes(d->context.info().max_allocation))};
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
  request.adaptive_target = o.adaptive_target;
  request.traversal = api::odprt_traversal(o.traversal, !first().global);
  request.balance = o.balance;
  request.n_slices = schedule.n_slices;
  request.ray_buffer = static_cast<std::uint32_t>(o.ray_buffer);
  request.device_memory = o.device_memory;
  // Parts that fit into one piece of memory with all that goes with them have no array that doesn't.
  if (const Device* small = too_small_for_an_array(); small != nullptr) {
    const std::uint64_t piece = small->context.info().max_allocation;
    request.device_memory = o.device_memory > 0 ? std::min(o.device_memory, piece) : piece;
  }
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
  return {std::move(result.image), std::move(result.samples), api::warnings_of(result)};
}

Drawn Renderer::Impl::draw_pdprt(const Job& job, const std::string& why) {
  std::vector<pdprt::Device> places;
  const std::size_t film_bytes = pdprt_film_bytes(job);
  for (const auto& d : devices)
    places.push_back({&d->context, &d->buffers(), &d->programs, schedule_for(*d, job)});
  const auto batch = [](const pdprt::Device& place) { return place.schedule.batch_size; };
  const std::uint32_t smallest = batch(*std::ranges::min_element(places, {}, batch));
  for (pdprt::Device& place : places) place.schedule.batch_size = smallest;  // the frame has it
  pdprt::Result result = pdprt::render(places, {.frame = job.frame,
                                                .features = job.features,
                                                .adaptive_target = job.options.adaptive_target,
                                                .division = job.options.division,
                                                .progress = job.options.progress,
                                                .faults = &faults,
                                                .timeline = job.timeline,
                                                .max_film_bytes = film_bytes});
  last_frame = {job.frame.width, job.frame.height, result.tile_cost};
  speeds.take(job.frame).pdprt = mrays_per_s(result.counters.total(), result.render_seconds);
  record_frame(job, result.counters, result.stage_seconds, result.render_seconds);
  api::Json mode = api::pdprt_json(result);
  mode["division"] = division_name(job.options.division);
  mode["schedule"] = first().global ? "global" : "slices";
  record_mode(job, std::move(mode), why);
  statistics["memory"].update(api::pdprt_memory_json(result, scene_bytes));
  return {std::move(result.image), std::move(result.samples), api::warnings_of(result)};
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
  mode["traversal"] =
      traversal_name(api::traversal_in(job.options.precision, job.options.traversal, first().context.info()));
  mode["precision"] = api::name_of(job.options.precision);
  mode["work_group"] = first().work_group;
  mode["programs"] = programs;
  mode["programs_known"] = devices.size() * wavefront::Programs::n_known();
  statistics["mode"] = std::move(mode);
}

// Looked for once, with the first frame.
void Renderer::Impl::use_core(Job& job) {
  constexpr std::uint32_t kTraces = KDRAY_FEATURE_LIGHTS | KDRAY_FEATURE_REFLECT | KDRAY_FEATURE_TRANSMIT;
  if (!(job.features & kTraces) || job.frame.keep_weightless) return;
  if (!core) core = flatten::core_of(scene.flat);
  core->apply(job.frame, scene.flat.lights);
  if (core->has_faces) job.features |= KDRAY_FEATURE_FACES;
}

Picture Renderer::Impl::render(const RenderOptions& options) {
  const RenderOptions o = flatten::resolved(options, scene.settings.settings);
  api::check_division(o);
  api::check_form(takes_binary_form(o.traversal, o.precision, o.channels), has_binary_form());
  timeline::Timeline kept;
  Job job{
      .options = o,
      .frame = flatten::make_frame(scene.settings, scene.geometry, o),
      .features = scene.features | flatten::features_of_samples(o.samples, o.adaptive_target > 0) | o.keep,
      .timeline = o.timeline ? &kept : nullptr};
  use_core(job);
  const Chosen chosen = choose_mode(job);
  Drawn drawn = chosen.mode == Mode::odprt ? draw_odprt(job, chosen.why) : draw_pdprt(job, chosen.why);
  timeline = o.timeline ? kept.json() : std::string();
  statistics["samples"] = api::samples_json(job.frame, drawn.samples ? &*drawn.samples : nullptr);
  Picture picture = to_picture(drawn.image, channels(job, drawn));
  picture.warnings = std::move(drawn.warnings);
  return picture;
}

// The samples' own counts come last.
std::vector<film::Channel> Renderer::Impl::channels(const Job& job, Drawn& drawn) {
  std::vector<std::string> names = job.options.channels;
  const auto samples = std::find(names.begin(), names.end(), "samples");
  const bool counted = samples != names.end();
  if (counted) names.erase(samples);
  std::vector<film::Channel> channels;
  if (!names.empty())
    channels = wavefront::render_channels(first().context, first().buffers(), first().programs, job.frame,
                                          job.features, job.options.precision, names);
  if (counted)
    channels.push_back({"samples", drawn.samples
                                       ? std::move(drawn.samples->counts)
                                       : std::vector<float>(drawn.image.pixels.size(),
                                                            static_cast<float>(job.frame.n_samples))});
  return channels;
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal wanted,
                                       Precision precision) {
  Traversal traversal = api::traversal_in(precision, wanted, first().context.info());
  api::check_form(takes_binary_form(traversal, precision), has_binary_form());
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  if (traversal == Traversal::automatic && first().global) traversal = Traversal::wide;
  wavefront::QueryResult result =
      wavefront::trace_query(first().context, first().buffers(), first().programs, scene.geometry,
                             scene.features, first().work_group, traversal, precision, rays, any_hit, repeat,
                             first().global ? wavefront::kBoundedLaunch : wavefront::kRaysPerChunk);
  const double seconds = median(result.seconds);
  statistics["seconds"]["compile"] = build_seconds();
  statistics["seconds"]["upload"] = upload_seconds();
  statistics["seconds"]["trace"] = seconds;
  statistics["rays"] = {{"total", rays.size()}};
  statistics["mrays_per_s"] = mrays_per_s(rays.size(), seconds);
  statistics["mode"] = {{"name", "query"},
                        {"queues", 1},
                        {"traversal", traversal_name(traversal)},
                        {"precision", api::name_of(precision)},
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

void open_device(const DeviceOptions& options) {
  for (const device::Context& context : api::open_devices(options)) work_group_of(options, context);
}

}  // namespace kdray
