#include "engine/pdprt/render.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "base/timer.h"
#include "engine/frame/driver.h"
#include "engine/pdprt/tile_client.h"
#include "engine/pdprt/tile_server.h"
#include "engine/pdprt/worker_pool.h"
#include "engine/wavefront/tile_order.h"

namespace kdray::pdprt {

namespace {

constexpr double kStep = 0.01;         // seconds between two looks at the time and the progress
constexpr double kRankStep = 0.001;    // ... at the messages of others
constexpr double kDeliverEvery = 1.0;  // seconds: that the sums of all tiles don't go home at the end

using Progress = std::function<void(double)>;

void nap() {
  std::this_thread::sleep_for(std::chrono::duration<double>(kRankStep));
}

// The fields of a queue that travel to rank 0.
template <class Stream, class Queue>
void pass(Stream& stream, Queue& queue) {
  frame::pass_queue(stream, queue);
  stream(queue.failure, queue.tiles, queue.tiles_lost);
}

transport::Bytes to_report(const Result& result) {
  transport::Writer writer;
  frame::put_share(result, writer);
  writer(result.tile_cost, result.queues.size());
  for (const QueueResult& queue : result.queues) pass(writer, queue);
  return writer.take();
}

void add_report(const transport::Message& message, Result& result) {
  transport::Reader reader(message);
  frame::add_share(reader, result);
  result.tile_cost.add(reader.get<TileCost>());
  for (auto n = reader.get<std::size_t>(); n > 0; --n) {
    QueueResult& queue = result.queues.emplace_back();
    pass(reader, queue);
    queue.number = result.queues.size() - 1;
    queue.rank = message.from;
  }
}

class Executor final : public frame::Executor {
 public:
  Executor(std::span<const Device> devices, const Task& task);

  const layout::Frame& frame() const override { return frame_; }
  std::span<const wavefront::Band> bands() const override { return bands_; }
  std::size_t n_samples() const override { return capacity_.samples; }
  frame::Entries render(frame::List list, const frame::Sink& sink, const Progress& progress) override;
  bool leads() const override { return !task_.ranks || task_.ranks->leads(); }
  void follow() override;

  // Adds what the queues have done, on rank 0 those of all ranks.
  void collect(Result& result);

 private:
  frame::Entries render_alone(frame::List list, const frame::Sink& sink, const Progress& progress);
  frame::Entries serve(frame::List list, const frame::Sink& sink, const Progress& progress);
  void check_entries(const Begin& list) const;
  SharedFrame shared_frame() const;
  TileHierarchy hierarchy() const { return TileHierarchy(task_.ranks->size(), task_.ranks_to_a_bag); }
  void collect_tile_seconds(Result& result) const;
  void add_reports(Result& result);

  const Task& task_;
  layout::Frame frame_;
  std::vector<wavefront::Band> bands_;
  wavefront::Capacity capacity_;
  std::optional<WorkerPool> pool_;
  std::optional<TileServer> server_;  // of rank 0
};

Executor::Executor(std::span<const Device> devices, const Task& task) : task_(task), frame_(task.frame) {
  devices.front().schedule.apply(frame_, task.features);
  bands_ = wavefront::bands_of(frame_, task.max_film_bytes);
  capacity_.tiles = std::size_t{bands_.front().n_rows} * frame_.n_tiles_x;
  capacity_.pixels = bands_.front().n_pixels;
  if (task.adaptive_target > 0)
    capacity_.samples = std::max(kLeastSamples, capacity_.pixels / KDRAY_SAMPLE_RUN * KDRAY_SAMPLE_RUN);
  pool_.emplace(devices, task, capacity_);
  pool_->require_one();
  pool_->shared().tile_queues.assign(frame_.n_tiles, kNobody);
  if (task.timeline) pool_->shared().tile_seconds.resize(frame_.n_tiles);
  if (task.ranks && task.ranks->leads()) server_.emplace(*task.ranks, shared_frame(), hierarchy());
}

SharedFrame Executor::shared_frame() const {
  return {task_.shared_frame, frame_.width, frame_.height, frame_.tile_width, frame_.tile_height};
}

frame::Entries Executor::render(frame::List list, const frame::Sink& sink, const Progress& progress) {
  pool_->shared().tiles_done = 0;
  return server_ ? serve(std::move(list), sink, progress) : render_alone(std::move(list), sink, progress);
}

frame::Entries Executor::render_alone(frame::List list, const frame::Sink& sink, const Progress& progress) {
  // A single queue takes everything at once.
  const Division division = pool_->size() == 1 ? Division::contiguous : task_.division;
  Tiles tiles(std::move(list.entries), division, pool_->size(), task_.checkpoint != nullptr);
  const Timer timer;
  pool_->render(
      tiles,
      {.sink = sink, .first_pixel = list.first_place, .samples = list.samples, .left_after = list.seconds},
      std::min(kStep, list.seconds), [&] {
        if (timer.seconds() >= list.seconds) tiles.close();
        progress(static_cast<double>(pool_->shared().tiles_done));
      });
  return tiles.left_over();
}

frame::Entries Executor::serve(frame::List list, const frame::Sink& sink, const Progress& progress) {
  Tiles own = Tiles::open(pool_->size(), list.entries.size());
  server_->begin({.of_runs = list.has_runs(), .first_pixel = list.first_place}, std::move(list.entries),
                 list.samples, sink);
  const Timer timer;
  frame::Entries left;
  const auto beside = [&] {
    if (timer.seconds() >= list.seconds && left.empty()) left = server_->close();
    server_->step(own);
    progress(static_cast<double>(pool_->shared().tiles_done + server_->n_rendered()));
  };
  beside();
  pool_->render(own, {.sink = sink, .first_pixel = list.first_place, .samples = list.samples}, kRankStep,
                beside);
  for (; !server_->is_done(); nap()) beside();
  return left;
}

// Rank 0's devices decide how a frame is cut into bands; this rank has space for the same.
void Executor::check_entries(const Begin& list) const {
  const bool known = std::ranges::any_of(
      bands_, [&](const wavefront::Band& band) { return band.first_pixel == list.first_pixel; });
  if (!known || list.n_entries > std::max(capacity_.tiles, capacity_.samples / KDRAY_SAMPLE_RUN))
    throw Error(ErrorCode::internal, "rank 0 has cut the picture otherwise than this rank");
}

void Executor::follow() {
  TileClient client(*task_.ranks, shared_frame(), hierarchy());
  const frame::Sink sink = [&](const auto& films, auto entries) { client.take(films, entries); };
  while (!client.is_finished()) {
    const auto list = client.next_list();
    if (!list) {
      nap();
      continue;
    }
    check_entries(list->head);
    pool_->shared().tiles_done = 0;
    Tiles tiles = Tiles::open(pool_->size(), list->head.n_entries);
    const auto beside = [&] { client.step(tiles, pool_->shared().tiles_done); };
    beside();
    pool_->render(tiles,
                  {.sink = sink,
                   .first_pixel = list->head.first_pixel,
                   .samples = list->samples,
                   .seconds = kDeliverEvery},
                  kRankStep, beside);
    for (; !client.is_done(); nap()) beside();
    client.finish_list();
  }
}

void Executor::collect_tile_seconds(Result& result) const {
  const std::vector<double>& costs = pool_->shared().tile_seconds;
  if (costs.empty() || result.tile_cost.total == 0) return;
  for (const wavefront::Band& band : bands_)
    for (const layout::u32 tile : wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows))
      result.tile_seconds.push_back(costs[KDRAY_TILE_ROW(tile) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tile)]);
}

void Executor::add_reports(Result& result) {
  for (server_->finish(); !server_->take_reports();) nap();
  std::vector<transport::Message> reports = server_->reports();
  std::ranges::sort(reports, {}, &transport::Message::from);
  for (const transport::Message& message : reports) add_report(message, result);
}

void Executor::collect(Result& result) {
  result.tile_queues = std::move(pool_->shared().tile_queues);
  result.tile_cost.tile_pixels = std::uint64_t{frame_.tile_width} * frame_.tile_height;
  pool_->collect(result);
  collect_tile_seconds(result);
  if (server_) return add_reports(result);
  if (!task_.ranks) return;
  for (QueueResult& queue : result.queues) queue.rank = task_.ranks->rank();
  task_.ranks->send(0, kReport, to_report(result));
}

}  // namespace

Result render(std::span<const Device> devices, const Task& task) {
  Executor executor(devices, task);
  Result result;
  frame::render_frame(executor, task, result);
  executor.collect(result);
  return result;
}

}  // namespace kdray::pdprt
