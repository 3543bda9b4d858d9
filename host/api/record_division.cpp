#include <fmt/format.h>

#include <algorithm>
#include <utility>

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

Statistics::Queue queue_told(const frame::QueueReport& queue, double render_seconds) {
  const double idle =
      render_seconds > 0 ? std::clamp(1 - queue.busy_seconds / render_seconds, 0.0, 1.0) : 0.0;
  return {.number = queue.number,
          .device = queue.device,
          .busy_seconds = queue.busy_seconds,
          .idle_share = idle,
          .rays = queue.rays,
          .tiles = {},
          .travel = {},
          .rank = {}};
}

Statistics::Travel travel_told(const odprt::Result& r, std::size_t q) {
  const odprt::QueueReport& queue = r.queues[q];
  return {.parts = queue.n_parts,
          .subtrees = queue.n_subtrees,
          .part_loads = queue.n_loads,
          .launches = queue.launches,
          .rays_in = moved(r.exchange, q, false, 1, 1),
          .rays_out = moved(r.exchange, q, true, 1, 1),
          .bytes_in = moved(r.exchange, q, false, kRayBytes, kShadowBytes),
          .bytes_out = moved(r.exchange, q, true, kRayBytes, kShadowBytes)};
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

// What both modes tell. Takes the picture.
template <class Result>
FrameResult common_result_of(Result& result, const State& state) {
  FrameResult told;
  Statistics::Division& division = told.division;
  division.tile_width = result.tile_width;
  division.tile_height = result.tile_height;
  division.tiles = result.n_tiles;
  division.bands = result.n_bands;
  division.launches = result.counters.launches;
  division.waves = result.counters.waves;
  division.samples_of_empty_blocks = result.counters.of_empty_blocks;
  for (const frame::QueueReport& queue : result.queues) {
    division.per_queue.push_back(queue_told(queue, result.render_seconds));
    if (state.ranks) division.per_queue.back().rank = queue.rank;
  }
  if (state.ranks) {
    const transport::Counters& c = state.ranks->counters();
    division.ranks =
        Statistics::Ranks{state.ranks->size(), c.sent, c.received, c.bytes_sent, c.bytes_received};
  }
  static_cast<frame::Result&>(told) = std::move(result);
  return told;
}

}  // namespace

FrameResult frame_result_of(pdprt::Result&& result, const State& state, const Job& job) {
  FrameResult told = common_result_of(result, state);
  told.frame_bytes = 0;
  for (const pdprt::QueueResult& queue : result.queues) {
    told.division.per_queue[queue.number].tiles = queue.tiles;
    *told.frame_bytes += queue.device_bytes;
    told.memory_of_queues.push_back({state.scene_bytes, queue.device_bytes});  // each sees the whole scene
    if (queue.failure.empty()) continue;
    told.division.quarantined.push_back({queue.number, queue.failure});
    told.warnings.push_back(fmt::format(
        "queue {} ({}){} failed: {}; the other queues rendered the {} tiles it had taken", queue.number,
        queue.device, queue.rank > 0 ? fmt::format(", which is rank {}'s,", queue.rank) : "", queue.failure,
        queue.tiles_lost));
  }
  told.owners = {result.tile_width, result.tile_height, std::move(result.tile_queues)};
  told.division.pdprt = Statistics::Pdprt{name_of(job.options.division), std::move(result.tile_seconds)};
  told.division.schedule = state.devices.first().global ? "global" : "slices";
  return told;
}

FrameResult frame_result_of(odprt::Result&& result, const State& state, const Job& job) {
  FrameResult told = common_result_of(result, state);
  for (std::size_t q = 0; q < result.queues.size(); ++q) {
    told.division.per_queue[q].travel = travel_told(result, q);
    told.memory_of_queues.push_back({result.queues[q].geometry_bytes, result.queues[q].device_bytes});
  }
  for (const odprt::Quarantined& q : result.quarantined) {
    told.division.quarantined.push_back({q.queue, q.what});
    told.warnings.push_back(
        fmt::format("queue {} failed: {}; its subtrees went to the other queues", q.queue, q.what));
  }
  told.owners.of_subtrees = std::move(result.subtree_queues);
  told.divide_seconds = result.divide_seconds;
  told.division.schedule = result.per_ray ? "global" : "slices";
  Statistics::Odprt odprt;
  odprt.balance = name_of(job.options.balance);
  odprt.parts = result.n_parts;
  odprt.directory_cells = result.n_cells;
  odprt.whole_geometry_bytes = state.divided->geometry_bytes();
  add_exchange(odprt, result.exchange);
  told.division.odprt = std::move(odprt);
  if (told.division.ranks) {
    told.division.ranks->whole = state.whole == nullptr;
    told.division.ranks->peak_bytes = std::move(result.peak_bytes);
  }
  return told;
}

}  // namespace kdray::api
