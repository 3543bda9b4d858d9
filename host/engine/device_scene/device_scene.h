// What    A scene that is ready, and the devices that have it: once, whether frames or queries work with it.
//         Who works with it shares it, so that it lives until the last picture and answer.
// Threads As of Device. What look() and tune() change is for whoever has it alone.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>

#include "accel/prepare/prepared.h"
#include "engine/device_scene/device.h"

namespace kdray::engine {

class DeviceScene {
 public:
  using TunedFor = std::function<Tuned(const device::Context&, bool global)>;

  // `contexts`: of at least one device, of which the first counts where one has to.
  DeviceScene(const prepare::Prepared& scene, std::span<const device::Context> contexts,
              const DeviceOptions& options, const std::string& build_options, const TunedFor& tuned_for);
  DeviceScene(const DeviceScene&) = delete;
  DeviceScene& operator=(const DeviceScene&) = delete;

  const prepare::Prepared& scene() const { return scene_; }
  // Takes camera, lights, sky and settings from a scene whose trees and primitives are this one's own.
  // Queries may go on meanwhile: they read none of these.
  void look(const prepare::Prepared& seen);
  // Those of frames: what the scene needs as it is seen.
  layout::Features features() const { return features_; }

  Device& first() { return devices_.front(); }
  const Device& first() const { return devices_.front(); }
  auto begin() { return devices_.begin(); }
  auto begin() const { return devices_.begin(); }
  auto end() { return devices_.end(); }
  auto end() const { return devices_.end(); }
  std::size_t size() const { return devices_.size(); }

  void tune(const Tuning& tuning);

  // Of all devices together.
  std::size_t n_queues() const;
  std::uint32_t n_units() const;
  double build_seconds() const;
  double upload_seconds() const;
  wavefront::ProgramsUsed programs_used() const;

  // Wall time that opening the devices took.
  struct {
    double start = 0, self_test = 0;
  } open_seconds;

 private:
  prepare::Prepared scene_;
  layout::Features features_;
  std::deque<Device> devices_;
};

}  // namespace kdray::engine
