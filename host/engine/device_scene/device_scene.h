// What    A scene that is ready, and the devices that have it: once, whether frames or queries work with it.
//         Who works with it shares it, so that it lives until the last picture and answer.
// Threads As of Device. What look() and tune() change is for whoever has it alone.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "accel/prepare/prepared.h"
#include "device/opencl/context.h"
#include "device/tuning/database.h"
#include "engine/wavefront/programs.h"
#include "engine/wavefront/scene_buffers.h"
#include "kdray/options.h"

namespace kdray::engine {

// The settings that a device works with.
struct Tuned {
  Tuning settings;
  tuning::Key key;
  std::string from;  // "shipped", "given", or the file and the features of its entry
};

// Whether each lane is a work-item and launches are short (Schedule::global): asked for, or by the kind of
// device.
bool runs_globally(const DeviceOptions& options, const device::Context& context);

// The local size that the options ask for, else the default as far as the device goes along.
std::size_t work_group_of(const DeviceOptions& options, const device::Context& context);

// A device that frames and queries work with: its context, its programs and settings, and the whole scene
// on it once that is wanted there. Errors: ErrorCode::usage for a work-group that the device can't run.
// Threads: buffers() and programs may be used by several threads; light_anew() and use() by one, while nobody
// else uses the device.
class Device {
 public:
  // `scene` has to outlive the device. `build_options` are for all of its programs.
  Device(const device::Context& opened, const DeviceOptions& options, const std::string& build_options,
         const prepare::Prepared& scene);
  Device(const Device&) = delete;  // its programs point to its context
  Device& operator=(const Device&) = delete;

  // Uploads the scene at the first call.
  const wavefront::SceneBuffers& buffers();
  double upload_seconds() const;

  // Uploads the lights of the scene, which have changed.
  void light_anew(bool with_sky);

  void use(const Tuned& settings);
  const Tuned& tuned() const { return tuned_; }

  const prepare::Prepared& scene() const { return scene_; }
  std::uint32_t units_of_a_queue() const;

  const device::Context context;
  std::size_t
      work_group;     // local size of kernels: as asked for, else the default as far as the device goes along
  const bool global;  // runs_globally()
  wavefront::Programs programs;

 private:
  int asked_work_group_;  // 0: chosen
  const prepare::Prepared& scene_;
  Tuned tuned_;
  mutable std::mutex uploading_;
  std::optional<wavefront::SceneBuffers> buffers_;
  double upload_seconds_ = 0;
};

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
