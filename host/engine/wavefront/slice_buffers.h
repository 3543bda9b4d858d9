// What    What the slices of a queue work in, on its device: the frame, the list of what there is to do, the
//         slices themselves, the streams of their rays and the film. A Wavefront has one, and so has each of
//         ODPRT's workers.
// Shape   By the names of the kernels' arguments (kernels/layout/arguments.h). The frame says how large the
//         pool is: by Schedule::apply() (wavefront.cpp), in ODPRT by make_plan() (odprt/plan.cpp).
// Errors  ErrorCode::out_of_memory, which says what there was no memory for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "device/opencl/context.h"
#include "device/opencl/kernel.h"
#include "layout/features.h"
#include "layout/frame.layout.h"
#include "layout/rays.layout.h"

namespace kdray::wavefront {

// Rays that one ray can put into the pool. Where one is refracted another may be reflected, if of no weight.
std::uint32_t spawned_per_ray(layout::Features features);

// The words of a ray that its cone takes: rays that wait, travel, or are in work have it.
std::uint32_t ray_cone_fields(layout::Features features);

// The words by which hits, and rays that carry one, name an instance.
std::uint32_t instance_fields(layout::Features features);

// All words of a ray of ODPRT.
std::uint32_t travel_ray_fields(layout::Features features);

// A stream's words per field for `n` rays: whole vectors, and one behind the last ray (rays.layout.h).
std::uint32_t capacity_for(std::uint32_t n);

// How much fits. The frame has the capacities of the streams.
struct SliceCapacity {
  std::uint32_t n_slices = 0;
  std::size_t entries = 0, samples = 0;  // of the list
  std::size_t places = 0;                // of the film
};

// How the streams of a program are made up.
struct StreamForm {
  std::size_t word = sizeof(float);  // bytes of a number
  std::uint32_t pools = 0;           // of a slice: depths whose rays may have to wait
  std::uint32_t pool_fields = 0, ray_fields = 0, shadow_fields = 0, hit_fields = KDRAY_HIT_FIELDS;
  bool sparse_pools = false;  // most of them are nearly empty at any time
  bool film_cleared = false;  // as it is made

  // The streams of the kernels of a single device, and of ODPRT's.
  static StreamForm of_device(const layout::Frame& frame, std::size_t word, layout::Features features = 0);
  static StreamForm of_odprt(const layout::Frame& frame, layout::Features features);

  // Of one slice's streams: all of them, and the largest.
  std::size_t bytes(const layout::Frame& frame) const;
  std::size_t largest(const layout::Frame& frame) const;

 private:
  friend struct SliceBuffers;
  std::size_t pool_bytes(const layout::Frame& frame) const;
  std::size_t batch_bytes(const layout::Frame& frame) const;
  std::size_t hit_bytes(const layout::Frame& frame) const;
  std::size_t shadow_bytes(const layout::Frame& frame) const;
};

struct SliceBuffers {
  SliceBuffers(const device::Context& context, const layout::Frame& frame, const SliceCapacity& capacity,
               const StreamForm& form);
  SliceBuffers(const SliceBuffers&) = delete;
  SliceBuffers& operator=(const SliceBuffers&) = delete;
  ~SliceBuffers();  // leaves the buffers to the next frame; no command may be using them

#define KDRAY_SLICE_BUFFERS(X) \
  X(frame) X(tiles) X(slices) X(pool) X(batch) X(hits) X(shadow_rays) X(occluded) X(film)
#define KDRAY_BUFFER(name) cl::Buffer name;
  KDRAY_SLICE_BUFFERS(KDRAY_BUFFER)
#undef KDRAY_BUFFER
  std::future<void> film_made;  // no command may use the film before; then it is cleared, if the form says so
  std::size_t bytes = 0;        // of all of them

  // Sets those of a kernel's arguments that are among the buffers. Kernel: device::Kernel<K>, or a stage of
  // it.
  template <template <class> class Kernel, class K>
  void set_arguments(Kernel<K>& kernel) const {
#define KDRAY_SET(name) KDRAY_SET_WHERE_TAKEN(K, kernel, name, name);
    KDRAY_SLICE_BUFFERS(KDRAY_SET)
#undef KDRAY_SET
  }

  // Fills streams and film with a word, once they are there.
  void fill(cl::CommandQueue& queue, cl_uint word) const;

 private:
  device::KeptBuffers& kept_;
  bool keeps_film_;  // one that has to be cleared is quicker made anew
};

// Slices at the beginning of a list: slice s takes the entries s, s + n, ...
std::vector<layout::Slice> fresh_slices(std::uint32_t n);

// Adds the device's cycles that each stage of a fused wave took, by the stage's name.
void add_cycles(std::span<const layout::Slice> slices, std::map<std::string, double>& cycles);

}  // namespace kdray::wavefront
