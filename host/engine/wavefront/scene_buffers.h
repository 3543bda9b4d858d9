// What    A flattened scene on the device; shared by all queues of a context, read only. Where the device
//         works in the host's memory, the buffers are the arrays themselves; or they are space that scenes
//         are copied to, one after the other.
// Shape   A buffer for each of KDRAY_SCENE_ARRAYS (kernels/layout/arguments.h), by the list's names.
#pragma once

#include <array>
#include <memory>

#include "accel/flatten/flatten.h"
#include "accel/flatten/wide.h"
#include "device/opencl/context.h"
#include "device/opencl/kernel.h"

namespace kdray::wavefront {

struct SceneBuffers {
#define KDRAY_BUFFER(access, type, name) cl::Buffer name;
  KDRAY_SCENE_ARRAYS(KDRAY_BUFFER)
#undef KDRAY_BUFFER

  // Each array has a slot in the list.
#define KDRAY_NAME(access, type, name) name,
  struct Slot {
    enum : std::size_t { KDRAY_SCENE_ARRAYS(KDRAY_NAME) kArrays };
  };
#undef KDRAY_NAME
  using Sizes = std::array<std::size_t, Slot::kArrays>;  // bytes

  SceneBuffers(const device::Context& context, const flatten::FlatScene& flat, const flatten::WideForm& wide);
  // Space for arrays of these sizes.
  SceneBuffers(const device::Context& context, const Sizes& sizes);

  static Sizes sizes_of(const flatten::FlatScene& flat, const flatten::WideForm& wide);

  // Copies a scene that there is space for, and waits for it.
  void copy(cl::CommandQueue& queue, const flatten::FlatScene& flat, const flatten::WideForm& wide);

  // The wide form's nodes compressed (layout/compressed.layout.h), for kernels that walk it with one ray to a
  // work-item: they read them in the place of wide_nodes. Made at the first call after the scene has come, by
  // one thread at a time.
  const cl::Buffer& compressed_nodes() const;

  // The scene's lights, and its sky, in place of others, of which there may have been more or fewer.
  void upload_lights(const device::Context& context, const flatten::FlatScene& flat, bool with_sky);

  // Sets those of a kernel's arguments that are arrays of the scene. Kernel: device::Kernel<K>, or a stage of
  // it.
  template <template <class> class Kernel, class K>
  void set_arguments(Kernel<K>& kernel) const {
#define KDRAY_SET(access, type, name) KDRAY_SET_WHERE_TAKEN(K, kernel, name, name);
    KDRAY_SCENE_ARRAYS(KDRAY_SET)
#undef KDRAY_SET
  }

 private:
  struct Compressed;
  std::shared_ptr<Compressed> compressed_;

  std::array<cl::Buffer*, Slot::kArrays> all();
};

}  // namespace kdray::wavefront
