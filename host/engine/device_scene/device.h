// What    A device that a Renderer works with: its context, its programs and settings, and the whole scene on
//         it once that is wanted there; and the set of all of them.
// Errors  ErrorCode::usage for a work-group that the device can't run.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "accel/prepare/prepared.h"
#include "api/hooks.h"
#include "api/tuning.h"
#include "device/opencl/context.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "kdray/kdray.h"

namespace kdray::api {

// The local size that the options ask for, else the default as far as the device goes along.
std::size_t work_group_of(const DeviceOptions& options, const device::Context& context);

// Schedule::global, asked for or by the kind of device.
bool runs_globally(const DeviceOptions& options, const device::Context& context);

class Device {
 public:
  // `scene` has to outlive the device.
  Device(const device::Context& opened, const DeviceOptions& options, const std::string& build_options,
         const prepare::Prepared& scene);
  Device(const Device&) = delete;  // its programs point to its context
  Device& operator=(const Device&) = delete;

  // Uploads the scene at the first call.
  const wavefront::SceneBuffers& buffers();

  // Uploads the lights of the scene, which have changed.
  void light_anew();

  void use(const Tuned& settings);

  std::uint32_t units_of_a_queue() const;

  device::Context context;
  std::size_t work_group;
  bool global;  // runs_globally()
  wavefront::Programs programs;
  double upload_seconds = 0;
  Tuned tuned;

 private:
  int asked_work_group_;  // 0: chosen
  const prepare::Prepared& scene_;
  std::optional<wavefront::SceneBuffers> buffers_;
};

class DeviceSet {
 public:
  DeviceSet(const DeviceOptions& options, const Hooks& hooks, const prepare::Prepared& scene);

  Device& first() { return devices_.front(); }  // queries and channels take it
  const Device& first() const { return devices_.front(); }
  auto begin() { return devices_.begin(); }
  auto begin() const { return devices_.begin(); }
  auto end() { return devices_.end(); }
  auto end() const { return devices_.end(); }
  const OpenSeconds& open_seconds() const { return open_seconds_; }
  std::size_t size() const { return devices_.size(); }

  void tune(const Tuning& tuning);

  // Of all devices together.
  std::size_t n_queues() const;
  std::uint32_t n_units() const;
  double build_seconds() const;
  double upload_seconds() const;
  wavefront::ProgramsUsed programs_used() const;

 private:
  std::deque<Device> devices_;
  OpenSeconds open_seconds_;
};

}  // namespace kdray::api
