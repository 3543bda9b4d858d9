#include "api/device.h"

#include <algorithm>
#include <string>

#include "api/open_devices.h"
#include "base/timer.h"

namespace kdray::api {

namespace {

constexpr std::size_t kDefaultWorkGroup = 64;

}  // namespace

bool runs_globally(const DeviceOptions& options, const device::Context& context) {
  if (options.schedule == Schedule::automatic) return context.info().kind != "cpu";
  return options.schedule == Schedule::global;
}

std::size_t work_group_of(const DeviceOptions& options, const device::Context& context) {
  const std::size_t largest = context.max_work_group();
  if (static_cast<std::size_t>(options.work_group) > largest)
    throw Error(ErrorCode::usage, "the work-group size is " + std::to_string(options.work_group) +
                                      "; this device takes " + std::to_string(largest) + " at most");
  return options.work_group > 0 ? static_cast<std::size_t>(options.work_group)
                                : std::min<std::size_t>(kDefaultWorkGroup, largest);
}

Device::Device(const device::Context& opened, const DeviceOptions& options, const std::string& build_options,
               const prepare::Prepared& scene)
    : context(opened),
      work_group(work_group_of(options, context)),
      global(runs_globally(options, context)),
      programs(context, scene.tree_depth, scene.wide, build_options),
      asked_work_group_(options.work_group),
      scene_(scene) {}

const wavefront::SceneBuffers& Device::buffers() {
  if (!buffers_) {
    const Timer timer;
    buffers_.emplace(context, scene_.flat, scene_.wide);
    upload_seconds = timer.seconds();
  }
  return *buffers_;
}

void Device::light_anew() {
  if (buffers_) buffers_->upload_lights(context, scene_.flat);
}

void Device::use(const Tuned& settings) {
  tuned = settings;
  programs.use(tuned.settings);
  const std::size_t own =
      tuned.settings.work_group > 0 ? static_cast<std::size_t>(tuned.settings.work_group) : kDefaultWorkGroup;
  if (asked_work_group_ == 0) work_group = std::min(own, context.max_work_group());
}

std::uint32_t Device::units_of_a_queue() const {
  const auto n_parts = static_cast<std::uint32_t>(context.n_sub_devices());
  return (context.info().compute_units + n_parts - 1) / n_parts;
}

DeviceSet::DeviceSet(const DeviceOptions& options, const Hooks& hooks, const prepare::Prepared& scene) {
  const OpenedDevices opened = open_devices(options, hooks.faults);
  open_seconds_ = opened.seconds;
  const tuning::Database tunings = read_tunings(options);
  for (const device::Context& context : opened.contexts) {
    Device& device = devices_.emplace_back(context, options, hooks.build_options, scene);
    device.use(tuned_for(context, device.global, scene.features, tunings, options.tunings.string()));
  }
}

void DeviceSet::tune(const Tuning& tuning) {
  for (Device& d : devices_)
    d.use({tuning::merged(tuning::shipped(d.context.info().kind), tuning), d.tuned.key, "given"});
}

std::size_t DeviceSet::n_queues() const {
  std::size_t n = 0;
  for (const Device& d : devices_) n += d.context.queues().size();
  return n;
}

std::uint32_t DeviceSet::n_units() const {
  std::uint32_t n = 0;
  for (const Device& d : devices_) n += d.context.info().compute_units;
  return n;
}

double DeviceSet::build_seconds() const {
  double seconds = 0;
  for (const Device& d : devices_) seconds += d.programs.build_seconds();
  return seconds;
}

wavefront::ProgramsUsed DeviceSet::programs_used() const {
  wavefront::ProgramsUsed used;
  for (const Device& d : devices_) used.add(d.programs.used());
  return used;
}

double DeviceSet::upload_seconds() const {
  double seconds = 0;
  for (const Device& d : devices_) seconds += d.upload_seconds;
  return seconds;
}

OpenSeconds open_device(const DeviceOptions& options, const Hooks& hooks) {
  const OpenedDevices opened = open_devices(options, hooks.faults);
  for (const device::Context& context : opened.contexts) work_group_of(options, context);
  return opened.seconds;
}

}  // namespace kdray::api

namespace kdray {

OpenSeconds open_device(const DeviceOptions& options) {
  return api::open_device(options, {});
}

}  // namespace kdray
