#include "engine/odprt/provision.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "base/error.h"
#include "engine/odprt/worker_pool.h"

namespace kdray::odprt {

namespace {

// A queue has so many outboxes, and with many parts fewer: with too few it waits for the others to read.
constexpr std::size_t kLeastOutboxes = 3, kMostOutboxes = 8, kOutboxPlaces = 16;
constexpr std::size_t kMaxFilmBytes = std::size_t{256} << 20;  // of a queue; larger pictures go in bands
// The most that the directory may take of a scene that isn't streamed.
constexpr std::size_t kMostDirectory = std::size_t{5120} * sizeof(layout::PartCell);
// The film's share of memory that is short. Each band goes through all parts, so the film is worth more than
// larger parts; and the more parts there are, the more cells every ray is tested against, so only one is held
// at a time.
constexpr std::size_t kFilmEighths = 3;

// Queues on the device that has most of them.
std::size_t queues_on_a_device(const Request& request) {
  std::map<const device::Context*, std::size_t> counts;
  std::size_t most = 1;
  for (const Queue& queue : request.queues) most = std::max(most, ++counts[queue.context]);
  return most;
}

// A round gets places for as many samples as the largest band has pixels.
void add_samples(WorkCapacity& capacity) {
  const std::size_t n_runs = (capacity.places + KDRAY_SAMPLE_RUN - 1) / KDRAY_SAMPLE_RUN;
  capacity.samples = capacity.places = n_runs * KDRAY_SAMPLE_RUN;
  capacity.entries = std::max(capacity.entries, n_runs);
}

// `of_queue` is the memory of a queue where parts are streamed.
Provision provide_for(const Request& request, std::uint32_t n_parts, bool streamed, std::size_t film_bytes,
                      std::size_t of_queue = 0) {
  Provision p;
  p.frame = request.frame;
  p.n_parts = n_parts;
  p.streamed = streamed;
  const PlanRequest plan{.features = request.features,
                         .n_parts = n_parts,
                         .n_queues = static_cast<std::uint32_t>(request.table.n_queues()),
                         .n_ranks = request.table.place().ranks,
                         // Where memory is short, there are no more slices than compute units, about.
                         .n_slices = streamed ? (request.n_slices + 15) / 16 : request.n_slices,
                         .wave_rays = request.wave_rays,
                         .ray_buffer = request.ray_buffer,
                         .memory = of_queue,
                         .streamed = streamed};
  if (host_sorts(plan))
    p.n_outboxes = 1;  // what is sent is copied at once
  else if (request.wave_rays > 0)
    p.n_outboxes = kLeastOutboxes;  // of many rays each
  else
    p.n_outboxes = std::clamp(kOutboxPlaces / n_parts, kLeastOutboxes, kMostOutboxes);
  p.plan = make_plan(p.frame, plan);
  p.bands = wavefront::bands_of(p.frame, film_bytes);
  for (const wavefront::Band& band : p.bands) p.capacity.places = std::max(p.capacity.places, band.n_pixels);
  p.capacity.entries = p.frame.n_tiles;
  if (request.adaptive_target > 0) add_samples(p.capacity);
  return p;
}

std::size_t work_of(const Provision& p) {
  return work_bytes(p.frame, p.plan, p.capacity.places, p.n_outboxes) +
         2 * sizeof(layout::u32) * p.capacity.samples;
}

Error too_little(const Request& request, std::size_t needed) {
  return Error(
      ErrorCode::out_of_memory,
      fmt::format(
          "a device memory of {} is too little for this scene: it takes {}M at least; take more, or a "
          "smaller picture",
          request.device_memory, (needed >> 20) + 1));
}

// The film gets a part of a queue's memory, its other buffers what they take, the parts the rest. Nothing,
// when that is too little for any number of parts.
std::optional<Provision> try_streamed(const Request& request, std::size_t geometry_bytes,
                                      std::size_t of_queue, std::uint32_t least_parts) {
  const double geometry = kMostOfEqualShare * static_cast<double>(geometry_bytes);
  auto n_parts = static_cast<std::uint32_t>(std::max<std::size_t>({request.queues.size(), 2, least_parts}));
  for (;;) {
    Provision p = provide_for(request, n_parts, true, of_queue / 8 * kFilmEighths, of_queue);
    const std::size_t work = work_of(p);
    if (work < of_queue && geometry / n_parts <= static_cast<double>(of_queue - work)) {
      p.most_geometry = of_queue - work;
      return p;
    }
    if (n_parts >= kMostParts) return std::nullopt;
    n_parts = std::min<std::uint32_t>(n_parts + std::max(n_parts / 2, 1u), kMostParts);
  }
}

Provision provide_streamed(const Request& request, std::size_t geometry_bytes, std::size_t of_queue,
                           std::uint32_t least_parts) {
  if (std::optional<Provision> p = try_streamed(request, geometry_bytes, of_queue, least_parts))
    return *std::move(p);
  while (!try_streamed(request, geometry_bytes, of_queue, least_parts)) of_queue += of_queue / 16 + 4096;
  throw too_little(request, of_queue * queues_on_a_device(request));
}

}  // namespace

Provision provide(const Request& request, std::size_t geometry_bytes, std::uint32_t least_parts) {
  const auto n_queues = static_cast<std::uint32_t>(request.table.n_queues());
  Provision all = provide_for(request, n_queues, false, kMaxFilmBytes);
  if (request.device_memory == 0) return all;
  if (all.plan.per_ray) geometry_bytes += geometry_bytes / 2;  // nodes lie there compressed as well
  const std::size_t of_queue = request.device_memory / queues_on_a_device(request);
  const double share = kMostOfEqualShare * static_cast<double>(geometry_bytes) / n_queues;
  if (static_cast<double>(work_of(all) + kMostDirectory) + share <= static_cast<double>(of_queue)) return all;
  return provide_streamed(request, geometry_bytes, of_queue, least_parts);
}

bool fits(const Provision& provision, const Division& division, const Request& request) {
  if (!provision.streamed) return true;
  const std::size_t largest =
      buffer_bytes(division, provision.plan.per_ray) + division.directory.size() * sizeof(layout::PartCell);
  if (largest <= provision.most_geometry) return true;
  if (provision.n_parts < kMostParts) return false;
  throw too_little(request, (work_of(provision) + largest) * queues_on_a_device(request));
}

}  // namespace kdray::odprt
