#include "pdprt/rank_report.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "pdprt/rank_messages.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kMostNames = 1 << 16, kMostQueues = 1 << 16;

// Values one after the other, and texts with their lengths before them.
class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_text(const std::string& text) {
    const std::string_view kept = std::string_view(text).substr(0, kMostNames);
    put(kept.size());
    bytes_.append(kept);
  }
  transport::Bytes take() { return std::move(bytes_); }

 private:
  transport::Bytes bytes_;
};

class Reader {
 public:
  explicit Reader(const transport::Message& message) : message_(message), rest_(message.bytes) {}

  template <class T>
  T get() {
    T value;
    if (rest_.size() < sizeof value) refuse(message_);
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  std::string get_text() {
    const auto n = get<std::size_t>();
    if (n > kMostNames || n > rest_.size()) refuse(message_);
    std::string text(rest_.substr(0, n));
    rest_.remove_prefix(n);
    return text;
  }

 private:
  const transport::Message& message_;
  std::string_view rest_;
};

}  // namespace

transport::Bytes to_report(const Result& result) {
  Writer writer;
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
  Reader reader(message);
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
