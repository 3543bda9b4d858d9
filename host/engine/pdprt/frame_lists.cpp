// One list of tiles, or of runs of samples: by this process alone, with other ranks, or for rank 0.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include "base/timer.h"
#include "engine/pdprt/frame.h"
#include "engine/pdprt/rank_report.h"
#include "engine/pdprt/tile_client.h"

namespace kdray::pdprt {

namespace {

constexpr double kStep = 0.01;         // seconds between two looks at the time and the progress
constexpr double kRankStep = 0.001;    // ... at the messages of others
constexpr double kDeliverEvery = 1.0;  // seconds: that the sums of all tiles don't go home at the end

void nap() {
  std::this_thread::sleep_for(std::chrono::duration<double>(kRankStep));
}

}  // namespace

std::vector<layout::u32> Frame::render_list(std::vector<layout::u32> list, const Work& work,
                                            const Destination& to, double seconds) {
  pool_->shared().deliver = to.own;
  return server_ ? serve_list(std::move(list), work, to.of_others, seconds)
                 : render_list_alone(std::move(list), work, seconds);
}

std::vector<layout::u32> Frame::render_list_alone(std::vector<layout::u32> list, const Work& work,
                                                  double seconds) {
  // A single queue takes everything at once.
  const Division division = pool_->size() == 1 ? Division::contiguous : task_.division;
  Tiles tiles(std::move(list), division, pool_->size(), task_.checkpoint != nullptr);
  const Timer timer;
  pool_->render(tiles, work, std::min(kStep, seconds), [&] {
    if (timer.seconds() >= seconds) tiles.close();
    tell_progress();
  });
  return tiles.left_over();
}

std::vector<layout::u32> Frame::serve_list(std::vector<layout::u32> list, const Work& work,
                                           TileServer::Take of_others, double seconds) {
  Tiles own = Tiles::open(pool_->size(), list.size());
  server_->begin({.of_runs = work.samples.empty() ? 0u : 1u, .first_pixel = work.first_pixel},
                 std::move(list), work.samples, std::move(of_others));
  const Timer timer;
  std::vector<layout::u32> left;
  const auto beside = [&] {
    if (timer.seconds() >= seconds && left.empty()) left = server_->close();
    server_->step(own);
    tell_progress();
  };
  beside();
  pool_->render(own, work, kRankStep, beside);
  for (; !server_->is_done(); nap()) beside();
  n_of_others_ += server_->n_rendered();
  return left;
}

// Rank 0's devices decide how a frame is cut into bands; this rank has room for the same.
void Frame::check_entries(const Begin& list) const {
  const bool known = std::ranges::any_of(
      bands_, [&](const wavefront::Band& band) { return band.first_pixel == list.first_pixel; });
  if (!known || list.n_entries > std::max(capacity_.tiles, capacity_.samples / KDRAY_SAMPLE_RUN))
    throw Error(ErrorCode::internal, "rank 0 has cut the picture otherwise than this rank");
}

void Frame::render_assigned(TileClient& client) {
  while (!client.is_finished()) {
    const auto list = client.next_list();
    if (!list) {
      nap();
      continue;
    }
    check_entries(list->head);
    pool_->shared().tiles_done = 0;
    const Work work{
        .first_pixel = list->head.first_pixel, .samples = list->samples, .seconds = kDeliverEvery};
    Tiles tiles = Tiles::open(pool_->size(), list->head.n_entries);
    const auto beside = [&] { client.step(tiles, pool_->shared().tiles_done); };
    beside();
    pool_->render(tiles, work, kRankStep, beside);
    for (; !client.is_done(); nap()) beside();
    client.finish_list();
  }
}

Result Frame::render_for_others() {
  pool_->require_one();
  TileClient client(*task_.ranks, shared_frame(), hierarchy());
  pool_->shared().deliver = [&](const wavefront::FilmSums& film, std::span<const layout::u32> entries) {
    client.deliver(film, entries);
  };
  const Timer timer;
  render_assigned(client);
  Result result = collect(timer.seconds());
  for (QueueResult& queue : result.queues) queue.rank = task_.ranks->rank();
  client.report(to_report(result));
  return result;
}

void Frame::add_reports(Result& result) {
  for (server_->finish(); !server_->take_reports();) nap();
  std::vector<transport::Message> reports = server_->reports();
  std::ranges::sort(reports, {}, &transport::Message::from);
  for (const transport::Message& message : reports) add_report(message, result);
}

}  // namespace kdray::pdprt
