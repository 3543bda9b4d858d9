// What    A device that frames and queries work with: its context, its programs and settings, and the whole
//         scene on it once that is wanted there.
// Errors  ErrorCode::usage for a work-group that the device can't run.
// Threads buffers() and programs may be used by several threads; light_anew() and use() by one, while nobody
//         else uses the device.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
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

}  // namespace kdray::engine
