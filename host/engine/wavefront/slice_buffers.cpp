#include "engine/wavefront/slice_buffers.h"

#include <algorithm>

#include "layout/features.h"

namespace kdray::wavefront {

namespace {

// Entries, and behind them two words for each sample; what is read beyond the last is left out.
std::size_t list_words(const SliceCapacity& capacity) {
  return capacity.entries + (capacity.samples > 0 ? 2 * capacity.samples + KDRAY_LANES : 0);
}

}  // namespace

std::uint32_t spawned_per_ray(layout::Features features) {
  if (features & KDRAY_FEATURE_TRANSMIT) return 2;
  return features & KDRAY_FEATURE_REFLECT ? 1 : 0;
}

std::uint32_t ray_cone_fields(layout::Features features) {
  return features & KDRAY_FEATURE_FOOTPRINTS ? 1 : 0;
}

std::uint32_t instance_fields(layout::Features features) {
  return features & KDRAY_FEATURE_INSTANCES ? 1 : 0;
}

std::uint32_t travel_ray_fields(layout::Features features) {
  const std::uint32_t of_sample = features & KDRAY_FEATURE_AREA_LIGHTS ? 1 : 0;
  return KDRAY_TRAVEL_RAY_FIELDS + instance_fields(features) + ray_cone_fields(features) + of_sample;
}

std::uint32_t capacity_for(std::uint32_t n) {
  return (n + 2 * KDRAY_LANES - 1) / KDRAY_LANES * KDRAY_LANES;
}

// Rays and hits name an instance where there are some (rays.layout.h).
StreamForm StreamForm::of_device(const layout::Frame& frame, std::size_t word, layout::Features features) {
  const std::uint32_t instance = instance_fields(features);
  const std::uint32_t of_ray = instance + frame.tells_sample + ray_cone_fields(features);
  StreamForm form;
  form.word = word;
  form.pools = frame.pool_size > 0 ? frame.max_depth - 1 : 0;
  form.pool_fields = KDRAY_POOL_FIELDS + of_ray;
  form.ray_fields = KDRAY_RAY_FIELDS + of_ray;
  form.shadow_fields = KDRAY_SHADOW_FIELDS + instance;
  form.hit_fields = KDRAY_HIT_FIELDS + instance;
  return form;
}

// Eye rays travel as well, so they have a pool; and of each depth's many rays few are there at a time.
StreamForm StreamForm::of_odprt(const layout::Frame& frame, layout::Features features) {
  StreamForm form;
  form.pools = frame.max_depth;
  form.pool_fields = form.ray_fields = travel_ray_fields(features);
  form.shadow_fields = KDRAY_TRAVEL_SHADOW_FIELDS + instance_fields(features);
  form.hit_fields = KDRAY_HIT_FIELDS + instance_fields(features);
  form.sparse_pools = true;
  form.film_cleared = true;
  return form;
}

std::size_t StreamForm::pool_bytes(const layout::Frame& frame) const {
  return word * pools * pool_fields * frame.pool_capacity;
}
std::size_t StreamForm::batch_bytes(const layout::Frame& frame) const {
  return word * ray_fields * frame.batch_capacity;
}
std::size_t StreamForm::hit_bytes(const layout::Frame& frame) const {
  return word * hit_fields * frame.batch_capacity;
}
std::size_t StreamForm::shadow_bytes(const layout::Frame& frame) const {
  return word * shadow_fields * frame.shadow_capacity;
}

// The occlusion flags are a byte for each shadow ray.
std::size_t StreamForm::bytes(const layout::Frame& frame) const {
  return sizeof(layout::Slice) + pool_bytes(frame) + batch_bytes(frame) + hit_bytes(frame) +
         shadow_bytes(frame) + frame.shadow_capacity;
}

std::size_t StreamForm::largest(const layout::Frame& frame) const {
  return std::max({sizeof(layout::Slice), pool_bytes(frame), batch_bytes(frame), shadow_bytes(frame)});
}

SliceBuffers::SliceBuffers(const device::Context& context, const layout::Frame& f,
                           const SliceCapacity& capacity, const StreamForm& form)
    : kept_(context.kept_buffers()), keeps_film_(!form.film_cleared || !context.works_in_host_memory()) {
  const auto make = [&](std::size_t n_bytes, const char* what) {
    bytes += n_bytes;
    return context.kept_buffer(n_bytes, what);
  };
  const std::size_t n = capacity.n_slices, pool_bytes = n * form.pool_bytes(f);
  const std::size_t film_bytes = capacity.places * 3 * sizeof(layout::i64);
  frame = make(sizeof(layout::Frame), "the frame");
  slices = make(n * sizeof(layout::Slice), "the slices");
  tiles = make(list_words(capacity) * sizeof(layout::u32), "the list of tiles");
  const std::optional<cl::Buffer> kept_pool = kept_.take(pool_bytes);
  pool = kept_pool           ? *kept_pool
         : form.sparse_pools ? context.sparse_buffer(CL_MEM_READ_WRITE, pool_bytes, "the ray pools")
                             : context.buffer(CL_MEM_READ_WRITE, pool_bytes, "the ray pools");
  batch = make(n * form.batch_bytes(f), "the ray batches");
  hits = make(n * form.hit_bytes(f), "the hits");
  shadow_rays = make(n * form.shadow_bytes(f), "the shadow rays");
  occluded = make(n * f.shadow_capacity, "the occlusion flags");
  const std::optional<cl::Buffer> kept_film = keeps_film_ ? kept_.take(film_bytes) : std::nullopt;
  film = kept_film ? *kept_film
                   : context.buffer_made_beside(CL_MEM_READ_WRITE, film_bytes, "the film", form.film_cleared,
                                                film_made);
  bytes += pool_bytes + film_bytes;
}

SliceBuffers::~SliceBuffers() {
  if (film_made.valid()) film_made.wait();
  if (!keeps_film_) film = {};
#define KDRAY_LEAVE(name) kept_.leave(name);
  KDRAY_SLICE_BUFFERS(KDRAY_LEAVE)
#undef KDRAY_LEAVE
}

void SliceBuffers::fill(cl::CommandQueue& queue, cl_uint word) const {
  for (const cl::Buffer* buffer : {&pool, &batch, &hits, &shadow_rays, &occluded, &film})
    queue.enqueueFillBuffer(*buffer, word, 0, buffer->getInfo<CL_MEM_SIZE>() / sizeof word * sizeof word);
}

std::vector<layout::Slice> fresh_slices(std::uint32_t n) {
  std::vector<layout::Slice> slices(n);
  for (std::uint32_t s = 0; s < n; ++s) {
    slices[s].tile = s;
    slices[s].tile_stride = n;
  }
  return slices;
}

void add_cycles(std::span<const layout::Slice> slices, std::map<std::string, double>& cycles) {
  for (const layout::Slice& slice : slices) {
    cycles["admit"] += static_cast<double>(slice.cycles_admit);
    cycles["trace_closest"] += static_cast<double>(slice.cycles_closest);
    cycles["shade"] += static_cast<double>(slice.cycles_shade);
    cycles["trace_shadow"] += static_cast<double>(slice.cycles_shadow);
    cycles["add"] += static_cast<double>(slice.cycles_add);
  }
}

}  // namespace kdray::wavefront
