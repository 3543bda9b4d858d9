#include <algorithm>

#include "api/names.h"
#include "api/record.h"
#include "layout/rays.layout.h"

namespace kdray::api {

namespace {

constexpr std::uint64_t kRayBytes = KDRAY_TRAVEL_RAY_FIELDS * sizeof(float);
constexpr std::uint64_t kShadowBytes = KDRAY_SENT_SHADOW_FIELDS * sizeof(float);

// Rays of both kinds that a queue has sent to others (`out`) or had from them; not those that it sent to
// itself.
std::uint64_t moved(const odprt::ExchangeCounts& exchange, std::size_t queue, bool out, std::uint64_t per_ray,
                    std::uint64_t per_shadow_ray) {
  std::uint64_t n = 0;
  for (std::size_t other = 0; other < exchange.rays.size(); ++other) {
    const std::size_t from = out ? queue : other, to = out ? other : queue;
    n += exchange.rays[from][to] * per_ray + exchange.shadow_rays[from][to] * per_shadow_ray;
  }
  return n;
}

Statistics::Queue queue_told(const odprt::Result& r, std::size_t q) {
  const odprt::QueueReport& queue = r.queues[q];
  return {.number = queue.number,
          .device = queue.device,
          .busy_seconds = queue.busy_seconds,
          .idle_share = r.render_seconds > 0 ? 1 - queue.busy_seconds / r.render_seconds : 0.0,
          .rays = queue.traced,
          .tiles = {},
          .travel = Statistics::Travel{.parts = queue.n_parts,
                                       .subtrees = queue.n_subtrees,
                                       .part_loads = queue.n_loads,
                                       .launches = queue.launches,
                                       .rays_in = moved(r.exchange, q, false, 1, 1),
                                       .rays_out = moved(r.exchange, q, true, 1, 1),
                                       .bytes_in = moved(r.exchange, q, false, kRayBytes, kShadowBytes),
                                       .bytes_out = moved(r.exchange, q, true, kRayBytes, kShadowBytes)},
          .rank = {}};
}

Statistics::Queue queue_told(const pdprt::Result& r, std::size_t q) {
  const pdprt::QueueResult& queue = r.queues[q];
  const double idle =
      r.render_seconds > 0 ? std::clamp(1 - queue.busy_seconds / r.render_seconds, 0.0, 1.0) : 0.0;
  return {.number = q,
          .device = queue.device,
          .busy_seconds = queue.busy_seconds,
          .idle_share = idle,
          .rays = queue.rays,
          .tiles = queue.tiles,
          .travel = {},
          .rank = {}};
}

void add_exchange(Statistics::Odprt& told, const odprt::ExchangeCounts& exchange) {
  for (std::size_t from = 0; from < exchange.rays.size(); ++from) {
    std::vector<std::uint64_t>& rays = told.rays.emplace_back();
    std::vector<std::uint64_t>& bytes = told.bytes.emplace_back();
    for (std::size_t to = 0; to < exchange.rays.size(); ++to) {
      const std::uint64_t n = exchange.rays[from][to], n_shadow = exchange.shadow_rays[from][to];
      rays.push_back(n + n_shadow);
      bytes.push_back(n * kRayBytes + n_shadow * kShadowBytes);
      told.rays_total += rays.back();
      told.bytes_total += bytes.back();
    }
  }
}

}  // namespace

Statistics::Division division_of(const pdprt::Result& result, const Job& job, bool global) {
  Statistics::Division division;
  division.tile_width = result.tile_width;
  division.tile_height = result.tile_height;
  division.tiles = result.n_tiles;
  division.bands = result.n_bands;
  division.launches = result.counters.launches;
  division.waves = result.counters.waves;
  division.pdprt =
      Statistics::Pdprt{name_of(job.options.division), global ? "global" : "slices", result.tile_seconds};
  for (std::size_t i = 0; i < result.queues.size(); ++i) {
    division.per_queue.push_back(queue_told(result, i));
    if (const std::string& what = result.queues[i].failure; !what.empty())
      division.quarantined.push_back({i, what});
  }
  return division;
}

Statistics::Division division_of(const odprt::Result& result, const Job& job, std::uint64_t bytes_of_whole) {
  Statistics::Division division;
  division.tile_width = job.frame.tile_width;
  division.tile_height = job.frame.tile_height;
  division.tiles = job.frame.n_tiles;
  division.bands = result.n_bands;
  division.waves = result.counters.waves;
  for (const odprt::QueueReport& queue : result.queues) division.launches += queue.launches;
  for (std::size_t q = 0; q < result.queues.size(); ++q) division.per_queue.push_back(queue_told(result, q));
  for (const odprt::Quarantined& q : result.quarantined) division.quarantined.push_back({q.queue, q.what});
  Statistics::Odprt& told = division.odprt.emplace();
  told.balance = name_of(job.options.balance);
  told.parts = result.n_parts;
  told.directory_cells = result.n_cells;
  told.whole_geometry_bytes = bytes_of_whole;
  add_exchange(told, result.exchange);
  return division;
}

}  // namespace kdray::api
