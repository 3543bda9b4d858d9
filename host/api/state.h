// What    What a Renderer keeps between its frames: the scene, the devices, and what former frames have told.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "accel/flatten/core.h"
#include "accel/prepare/prepared.h"
#include "api/hooks.h"
#include "api/scheduler.h"
#include "base/hash.h"
#include "cluster/transport/ranks.h"
#include "device/opencl/fault_injector.h"
#include "engine/device_scene/device_scene.h"
#include "engine/odprt/render.h"

namespace kdray::api {

using engine::Device;

// Mrays/s of the last frames of one size, by mode; 0: not measured.
struct Speeds {
  std::uint32_t width = 0, height = 0;
  double pdprt = 0, odprt = 0;

  bool are_of(const layout::Frame& frame) const { return width == frame.width && height == frame.height; }
  // Forgets those of another size.
  Speeds& take(const layout::Frame& frame) {
    if (!are_of(frame)) *this = {frame.width, frame.height, 0, 0};
    return *this;
  }
};

// Its parts refer to each other, so it stays where it was made.
struct State {
  State(std::shared_ptr<engine::DeviceScene> shared, const Hooks& hooks)
      : shared_devices(std::move(shared)),
        devices(*shared_devices),
        scene(devices.scene()),
        scene_bytes(scene.bytes()),
        scheduler(devices, hooks.ranks ? static_cast<std::uint32_t>(hooks.ranks->size()) : 1),
        fault_injector(hooks.faults),
        keep(hooks.keep),
        ranks(hooks.ranks),
        whole(hooks.whole) {
    if (whole) core = whole->core, primitives = whole->primitives;
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  const std::shared_ptr<engine::DeviceScene> shared_devices;
  engine::DeviceScene& devices;
  const prepare::Prepared& scene;
  std::size_t scene_bytes;  // of its arrays, on a device that has all of it
  Scheduler scheduler;
  device::FaultInjector fault_injector;
  std::unique_ptr<odprt::DividedScene> divided;  // once a frame was rendered in ODPRT
  Speeds speeds;
  std::uint64_t keep;                       // Hooks::keep
  std::shared_ptr<transport::Ranks> ranks;  // Hooks::ranks
  std::shared_ptr<const WholeScene> whole;  // Hooks::whole
  std::optional<flatten::Core> core;        // looked for with the first frame that could make use of it
  std::optional<Hash> primitives;           // their hash, made for the first checkpoint or ranks
};

}  // namespace kdray::api
