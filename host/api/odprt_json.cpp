#include "api/odprt_json.h"

#include <numeric>

#include "api/names.h"
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

Json queue_json(const odprt::Result& r, std::size_t q) {
  const odprt::QueueReport& queue = r.queues[q];
  return {{"queue", queue.number},
          {"device", queue.device},
          {"busy_seconds", queue.busy_seconds},
          {"idle_share", r.render_seconds > 0 ? 1 - queue.busy_seconds / r.render_seconds : 0.0},
          {"rays", queue.traced},
          {"parts", queue.n_parts},
          {"subtrees", queue.n_subtrees},
          {"part_loads", queue.n_loads},
          {"launches", queue.launches},
          {"rays_in", moved(r.exchange, q, false, 1, 1)},
          {"rays_out", moved(r.exchange, q, true, 1, 1)},
          {"bytes_in", moved(r.exchange, q, false, kRayBytes, kShadowBytes)},
          {"bytes_out", moved(r.exchange, q, true, kRayBytes, kShadowBytes)}};
}

Json exchange_json(const odprt::Result& r) {
  Json rays = Json::array(), bytes = Json::array();
  std::uint64_t n_rays = 0, n_bytes = 0;
  for (std::size_t from = 0; from < r.exchange.rays.size(); ++from) {
    Json ray_row = Json::array(), byte_row = Json::array();
    for (std::size_t to = 0; to < r.exchange.rays.size(); ++to) {
      const std::uint64_t n = r.exchange.rays[from][to], n_shadow = r.exchange.shadow_rays[from][to];
      ray_row.push_back(n + n_shadow);
      byte_row.push_back(n * kRayBytes + n_shadow * kShadowBytes);
      n_rays += n + n_shadow;
      n_bytes += n * kRayBytes + n_shadow * kShadowBytes;
    }
    rays.push_back(ray_row);
    bytes.push_back(byte_row);
  }
  return {{"rays", rays}, {"bytes", bytes}, {"rays_total", n_rays}, {"bytes_total", n_bytes}};
}

}  // namespace

Json odprt_mode_json(const odprt::Result& r, const RenderOptions& options, std::size_t bytes_of_whole) {
  Json mode = {{"name", "odprt"},
               {"balance", name_of(options.balance)},
               {"parts", r.n_parts},
               {"directory_cells", r.n_cells},
               {"whole_geometry_bytes", bytes_of_whole},
               {"waves", r.counters.waves},
               {"bands", r.n_bands},
               {"quarantined", Json::array()},
               {"per_queue", Json::array()},
               {"exchange", exchange_json(r)}};
  for (const odprt::Quarantined& q : r.quarantined)
    mode["quarantined"].push_back({{"queue", q.queue}, {"what", q.what}});
  for (std::size_t q = 0; q < r.queues.size(); ++q) mode["per_queue"].push_back(queue_json(r, q));
  mode["launches"] =
      std::accumulate(r.queues.begin(), r.queues.end(), std::uint64_t{0},
                      [](std::uint64_t n, const odprt::QueueReport& q) { return n + q.launches; });
  return mode;
}

Json odprt_memory_json(const odprt::Result& r) {
  Json queues = Json::array();
  for (const odprt::QueueReport& q : r.queues)
    queues.push_back({{"geometry_bytes", q.geometry_bytes}, {"work_bytes", q.work_bytes}});
  return queues;
}

}  // namespace kdray::api
