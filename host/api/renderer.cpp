#include <algorithm>
#include <cmath>

#include "base/timer.h"
#include "flatten/features.h"
#include "flatten/frame.h"
#include "kdray/kdray.h"
#include "kdtree/build.h"
#include "pdprt/render.h"
#include "scene/geometry.h"
#include "statistics.h"
#include "wavefront/channels.h"
#include "wavefront/query.h"

namespace kdray {

namespace {

constexpr std::size_t kDefaultWorkGroup = 64;

// Runs `work` and files its wall time under `name`.
template <class Work>
auto timed(api::Json& seconds, const char* name, Work&& work) {
  const Timer timer;
  auto result = work();
  seconds[name] = timer.seconds();
  return result;
}

kdtree::BuildConfig config_of(const TreeOptions& o, std::size_t n_primitives) {
  kdtree::BuildConfig config;
  config.max_depth = o.max_depth;
  config.cost_traverse = o.cost_traverse;
  config.cost_intersect = o.cost_intersect;
  config.empty_bonus = o.empty_bonus;
  return kdtree::suited(config, n_primitives);
}

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
  picture.rgb.reserve(image.pixels.size() * 3);
  for (const vec3& p : image.pixels) picture.rgb.insert(picture.rgb.end(), {p.x, p.y, p.z});
  for (film::Channel& c : channels) picture.channels.push_back({std::move(c.name), std::move(c.values)});
  return picture;
}

}  // namespace

struct Renderer::Impl {
  Impl(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device);

  Picture render(const RenderOptions& options);
  std::vector<Hit> trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal);
  wavefront::Schedule schedule_for(const layout::Frame& frame, const RenderOptions& options) const;
  void record(const pdprt::Result& result, const layout::Frame& frame, std::uint32_t features,
              Traversal traversal);

  // The parts of the scene that a frame needs (camera, lights, materials): its geometry is on the device.
  scene::Scene settings;
  scene::Geometry geometry;
  std::uint32_t features = 0;
  int tree_depth = 0;
  std::unique_ptr<device::Context> context;
  std::unique_ptr<wavefront::SceneBuffers> buffers;
  std::unique_ptr<wavefront::Programs> programs;
  std::size_t work_group = kDefaultWorkGroup;
  api::Json statistics;
};

Renderer::Impl::Impl(const Scene& scene, const TreeOptions& tree_options,
                     const DeviceOptions& device_options) {
  check(device_options);
  const scene::Scene& model = scene.model();
  api::Json& seconds = statistics["seconds"];
  // The device first: without one there is no use in building a tree.
  context = std::make_unique<device::Context>(device_options.device, device_options.queues,
                                              device_options.compute_units);
  work_group = work_group_of(device_options, *context);

  const Timer build_timer;
  geometry = scene::make_geometry(model);
  const kdtree::BuildConfig config = config_of(tree_options, geometry.size());
  const kdtree::Tree tree = kdtree::build(geometry, config);
  seconds["build"] = build_timer.seconds();
  geometry.bounds = tree.bounds;  // the root's cell: what the rays are clipped to
  tree_depth = tree.max_depth;
  features = flatten::features_of(model, geometry);

  const auto [flat, wide] = timed(seconds, "flatten", [&] {
    flatten::FlatScene scene_arrays = flatten::flatten(model, geometry, tree);
    flatten::WideForm form = flatten::make_wide(tree, scene_arrays, flatten::choose_block(tree));
    return std::pair{std::move(scene_arrays), std::move(form)};
  });
  buffers = timed(seconds, "upload",
                  [&] { return std::make_unique<wavefront::SceneBuffers>(*context, flat, wide); });
  programs = std::make_unique<wavefront::Programs>(*context, tree_depth, wide);
  seconds["compile"] = 0.0;

  statistics["tree"] = api::tree_json(tree, kdtree::measure(tree, geometry, config));
  statistics["memory"] = {{"scene_bytes", flat.bytes() + wide.bytes()}};
  statistics["device"] = api::device_json(context->info());
  statistics["features"] = api::features_json(features);
  statistics["scene"] = {{"primitives", model.primitive_count()},
                         {"triangles", geometry.triangles.size()},
                         {"spheres", geometry.spheres.size()},
                         {"cones", geometry.cones.size()},
                         {"lights", model.lights.size()},
                         {"materials", model.materials.size()},
                         {"dropped_degenerate", geometry.dropped_degenerate}};
  settings.materials = model.materials;
  settings.lights = model.lights;
  settings.camera = model.camera;
  settings.background = model.background;
  settings.ambient = model.ambient;
  settings.settings = model.settings;
  // What stays of the geometry are its centre and bounds; the primitives are on the device.
  geometry.triangles = {};
  geometry.spheres = {};
  geometry.cones = {};
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
  const std::uint64_t slices = std::max<std::uint64_t>(schedule.n_slices, 16 * context->info().compute_units);
  schedule.n_slices = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(tiles_x * tiles_y, 1, slices));
  schedule.traversal = options.traversal;
  schedule.fused = context->info().kind == "cpu";
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
                        {"queues", context->queues().size()},
                        {"sub_devices", context->n_sub_devices()},
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
  const RenderOptions o = flatten::resolved(options, settings.settings);
  const layout::Frame frame = flatten::make_frame(settings, geometry, o);
  const std::uint32_t used = features | flatten::features_of_samples(o.samples);
  const pdprt::Result result =
      pdprt::render(*context, *buffers, *programs, frame, schedule_for(frame, o), used, o.progress);
  record(result, frame, used, options.traversal);
  return to_picture(result.image,
                    wavefront::render_channels(*context, *buffers, *programs, frame, used, o.channels));
}

std::vector<Hit> Renderer::Impl::trace(std::span<const Ray> rays, bool any_hit, int repeat,
                                       Traversal wanted) {
  // Packets and batches are explicit vectors, for CPUs; elsewhere the lanes are work-items.
  const Traversal traversal =
      wanted == Traversal::automatic && context->info().kind != "cpu" ? Traversal::wide : wanted;
  wavefront::QueryResult result = wavefront::trace_query(*context, *buffers, *programs, geometry, features,
                                                         work_group, traversal, rays, any_hit, repeat);
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

Renderer::Renderer(const Scene& scene, const TreeOptions& tree, const DeviceOptions& device)
    : impl_(std::make_unique<Impl>(scene, tree, device)) {}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

Picture Renderer::render(const RenderOptions& options) {
  return impl_->render(options);
}
std::vector<Hit> Renderer::trace(std::span<const Ray> rays, bool any_hit, int repeat, Traversal traversal) {
  return impl_->trace(rays, any_hit, repeat, traversal);
}
std::string Renderer::statistics() const {
  return impl_->statistics.dump(2);
}

}  // namespace kdray
