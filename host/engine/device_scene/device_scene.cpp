#include "engine/device_scene/device_scene.h"

#include <algorithm>

#include "base/error.h"
#include "base/timer.h"

namespace kdray::engine {

namespace {

// Most of a wave's kernels do little for each ray, and a GPU starts large groups faster: from 64 to 128 an
// H100's frames take 2 to 6% less time.
std::size_t usual_work_group(const device::Context& context) {
  return std::min<std::size_t>(context.info().kind == "cpu" ? 64 : 128, context.max_work_group());
}

}  // namespace

bool runs_globally(const DeviceOptions& options, const device::Context& context) {
  if (options.schedule == Schedule::automatic)
    return context.info().kind != "cpu" && context.adds_64_bits_atomically();
  return options.schedule == Schedule::global;
}

std::size_t work_group_of(const DeviceOptions& options, const device::Context& context) {
  const std::size_t largest = context.max_work_group();
  if (static_cast<std::size_t>(options.work_group) > largest)
    throw Error(ErrorCode::usage, "the work-group size is " + std::to_string(options.work_group) +
                                      "; this device takes " + std::to_string(largest) + " at most");
  return options.work_group > 0 ? static_cast<std::size_t>(options.work_group) : usual_work_group(context);
}

Device::Device(const device::Context& opened, const DeviceOptions& options, const std::string& build_options,
               const prepare::Prepared& scene)
    : context(opened),
      work_group(work_group_of(options, context)),
      global(runs_globally(options, context)),
      programs(context, scene.tree_depth, scene.wide, build_options),
      asked_work_group_(options.work_group),
      scene_(scene) {
  programs.query_alone(global);
}

const wavefront::SceneBuffers& Device::buffers() {
  const std::lock_guard lock(uploading_);
  if (!buffers_) {
    const Timer timer;
    buffers_.emplace(context, scene_.flat, scene_.wide);
    upload_seconds_ = timer.seconds();
  }
  return *buffers_;
}

double Device::upload_seconds() const {
  const std::lock_guard lock(uploading_);
  return upload_seconds_;
}

void Device::light_anew(bool with_sky) {
  const std::lock_guard lock(uploading_);
  if (buffers_) buffers_->upload_lights(context, scene_.flat, with_sky);
}

void Device::use(const Tuned& settings) {
  tuned_ = settings;
  programs.use(tuned_.settings);
  const std::size_t own = tuned_.settings.work_group > 0
                              ? static_cast<std::size_t>(tuned_.settings.work_group)
                              : usual_work_group(context);
  if (asked_work_group_ == 0) work_group = std::min(own, context.max_work_group());
}

std::uint32_t Device::units_of_a_queue() const {
  const auto n_parts = static_cast<std::uint32_t>(context.n_sub_devices());
  return (context.info().compute_units + n_parts - 1) / n_parts;
}

DeviceScene::DeviceScene(const prepare::Prepared& scene, std::span<const device::Context> contexts,
                         const DeviceOptions& options, const std::string& build_options,
                         const TunedFor& tuned_for)
    : scene_(scene), features_(scene.features) {
  for (const device::Context& context : contexts) {
    Device& device = devices_.emplace_back(context, options, build_options, scene_);
    device.use(tuned_for(context, device.global));
  }
}

void DeviceScene::look(const prepare::Prepared& seen) {
  scene_.settings = seen.settings;
  features_ = seen.features;
  scene_.flat.lights = seen.flat.lights;
  const bool other_sky = scene_.flat.sky.data() != seen.flat.sky.data();
  scene_.flat.sky = seen.flat.sky, scene_.flat.sky_colors = seen.flat.sky_colors;
  for (Device& device : devices_) device.light_anew(other_sky);
}

void DeviceScene::tune(const Tuning& tuning) {
  for (Device& d : devices_)
    d.use({tuning::merged(tuning::shipped(d.context.info().kind), tuning), d.tuned().key, "given"});
}

std::size_t DeviceScene::n_queues() const {
  std::size_t n = 0;
  for (const Device& d : devices_) n += d.context.queues().size();
  return n;
}

std::uint32_t DeviceScene::n_units() const {
  std::uint32_t n = 0;
  for (const Device& d : devices_) n += d.context.info().compute_units;
  return n;
}

double DeviceScene::build_seconds() const {
  double seconds = 0;
  for (const Device& d : devices_) seconds += d.programs.build_seconds();
  return seconds;
}

wavefront::ProgramsUsed DeviceScene::programs_used() const {
  wavefront::ProgramsUsed used;
  for (const Device& d : devices_) used.add(d.programs.used());
  return used;
}

double DeviceScene::upload_seconds() const {
  double seconds = 0;
  for (const Device& d : devices_) seconds += d.upload_seconds();
  return seconds;
}

}  // namespace kdray::engine
