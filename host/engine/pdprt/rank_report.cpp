#include "engine/pdprt/rank_report.h"

#include <algorithm>

#include "cluster/transport/values.h"
#include "engine/pdprt/rank_messages.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kMostQueues = 1 << 16;

}  // namespace

transport::Bytes to_report(const Result& result) {
  transport::Writer writer;
  writer.put(result.counters);
  writer.put(result.tile_cost);
  writer.put(result.stage_seconds.size());
  for (const auto& [stage, seconds] : result.stage_seconds) writer.put_text(stage), writer.put(seconds);
  writer.put(result.queues.size());
  for (const QueueResult& queue : result.queues) {
    writer.put_text(queue.device);
    writer.put_text(queue.failure);
    for (const std::uint64_t n :
         {queue.rays, queue.tiles, std::uint64_t{queue.device_bytes}, queue.tiles_lost})
      writer.put(n);
    writer.put(queue.busy_seconds);
  }
  return writer.take();
}

void add_report(const transport::Message& message, Result& result) {
  transport::Reader reader(message);
  result.counters.add(reader.get<wavefront::Counters>());
  const auto cost = reader.get<TileCost>();
  result.tile_cost.costliest = std::max(result.tile_cost.costliest, cost.costliest);
  result.tile_cost.total += cost.total;
  const auto n_stages = reader.get<std::size_t>();
  if (n_stages > kMostQueues) refuse(message);
  for (std::size_t i = 0; i < n_stages; ++i) {
    const std::string stage = reader.get_text();
    result.stage_seconds[stage] += reader.get<double>();
  }
  const auto n_queues = reader.get<std::size_t>();
  if (n_queues > kMostQueues) refuse(message);
  for (std::size_t i = 0; i < n_queues; ++i) {
    QueueResult queue;
    queue.device = reader.get_text();
    queue.failure = reader.get_text();
    queue.rays = reader.get<std::uint64_t>();
    queue.tiles = reader.get<std::uint64_t>();
    queue.device_bytes = reader.get<std::uint64_t>();
    queue.tiles_lost = reader.get<std::uint64_t>();
    queue.busy_seconds = reader.get<double>();
    queue.rank = message.from;
    result.queues.push_back(std::move(queue));
  }
}

}  // namespace kdray::pdprt
