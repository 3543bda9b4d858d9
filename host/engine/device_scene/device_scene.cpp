#include "engine/device_scene/device_scene.h"

namespace kdray::engine {

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
