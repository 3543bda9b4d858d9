#include "engine/odprt/rank_report.h"

#include "cluster/transport/values.h"

namespace kdray::odprt {

namespace {

constexpr std::size_t kMostStages = 1 << 10;

void put(const QueueReport& queue, transport::Writer& writer) {
  writer.put_text(queue.device);
  writer.put(queue.busy_seconds);
  for (const std::uint64_t n : {queue.launches, queue.waves, queue.traced, queue.n_loads,
                                std::uint64_t{queue.geometry_bytes}, std::uint64_t{queue.work_bytes}})
    writer.put(n);
  writer.put(queue.n_parts);
  writer.put(queue.n_subtrees);
}

QueueReport queue_of(transport::Reader& reader) {
  QueueReport queue;
  queue.device = reader.get_text();
  queue.busy_seconds = reader.get<double>();
  for (std::uint64_t* n : {&queue.launches, &queue.waves, &queue.traced, &queue.n_loads})
    *n = reader.get<std::uint64_t>();
  queue.geometry_bytes = reader.get<std::uint64_t>();
  queue.work_bytes = reader.get<std::uint64_t>();
  queue.n_parts = reader.get<std::uint32_t>();
  queue.n_subtrees = reader.get<std::uint32_t>();
  return queue;
}

}  // namespace

transport::Bytes to_report(const Result& result, const RankTable& table) {
  transport::Writer writer;
  writer.put(result.counters);
  writer.put(result.peak_bytes[table.place().rank]);
  writer.put(result.stage_seconds.size());
  for (const auto& [stage, seconds] : result.stage_seconds) writer.put_text(stage), writer.put(seconds);
  for (std::size_t q = 0; q < table.n_own(); ++q) {
    put(result.queues[q], writer);
    for (const std::uint64_t n : result.exchange.rays[table.own_first() + q]) writer.put(n);
    for (const std::uint64_t n : result.exchange.shadow_rays[table.own_first() + q]) writer.put(n);
  }
  return writer.take();
}

void add_report(const transport::Message& message, const RankTable& table, Result& result) {
  transport::Reader reader(message);
  result.counters.add(reader.get<wavefront::Counters>());
  result.peak_bytes[static_cast<std::size_t>(message.from)] = reader.get<std::uint64_t>();
  const auto n_stages = reader.get<std::size_t>();
  if (n_stages > kMostStages) transport::refuse(message);
  for (std::size_t i = 0; i < n_stages; ++i) {
    const std::string stage = reader.get_text();
    result.stage_seconds[stage] += reader.get<double>();
  }
  const auto from = static_cast<std::size_t>(message.from);
  for (std::size_t q = table.first[from]; q < table.first[from + 1]; ++q) {
    result.queues[q] = queue_of(reader);
    result.queues[q].number = q;
    result.queues[q].rank = message.from;
    for (std::uint64_t& n : result.exchange.rays[q]) n = reader.get<std::uint64_t>();
    for (std::uint64_t& n : result.exchange.shadow_rays[q]) n = reader.get<std::uint64_t>();
  }
}

}  // namespace kdray::odprt
