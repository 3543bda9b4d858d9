#include "pdprt/render.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "base/timer.h"
#include "pdprt/tiles.h"
#include "wavefront/develop.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kMaxFilmBytes = std::size_t{256} << 20;  // per queue; larger pictures go in bands

// What the queues' threads share.
struct Frame {
  Bag bag;
  film::Image image;  // bands are disjoint: each queue writes its own
  int samples;
  std::mutex wait_mutex;
  std::condition_variable changed;
  std::uint32_t n_running = 0;
  std::atomic<std::uint32_t> tiles_done{0};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
};

// Serves one queue until the bag is empty or another queue has failed.
void serve(Frame& shared, wavefront::Wavefront& queue) {
  const auto tiles_done = [&](std::uint32_t n) {
    shared.tiles_done += n;
    shared.changed.notify_one();
  };
  while (!shared.failed) {
    const std::optional<Band> band = shared.bag.take();
    if (!band) return;
    const std::span pixels = std::span(shared.image.pixels).subspan(band->first_pixel, band->n_pixels);
    queue.render_tiles(
        band->first_tile, band->end_tile, band->first_pixel, band->n_pixels, tiles_done,
        [&](std::span<const layout::i64> sums) { wavefront::develop(sums, shared.samples, pixels); });
  }
}

void run_queue(Frame& shared, wavefront::Wavefront& queue) {
  try {
    serve(shared, queue);
  } catch (...) {
    const std::lock_guard lock(shared.wait_mutex);
    if (!shared.failed.exchange(true)) shared.failure = std::current_exception();
  }
  const std::lock_guard lock(shared.wait_mutex);
  --shared.n_running;
  shared.changed.notify_one();
}

// Reports progress from the calling thread until every queue is done.
void wait(Frame& shared, std::uint32_t n_tiles, const std::function<void(double)>& progress) {
  using namespace std::chrono_literals;
  std::unique_lock lock(shared.wait_mutex);
  while (shared.n_running > 0) {
    shared.changed.wait_for(lock, 100ms);
    if (!progress) continue;
    lock.unlock();
    progress(static_cast<double>(shared.tiles_done) / n_tiles);
    lock.lock();
  }
}

}  // namespace

Result render(const device::Context& context, const wavefront::SceneBuffers& scene,
              wavefront::Programs& programs, layout::Frame frame, const wavefront::Schedule& schedule,
              std::uint32_t features, const std::function<void(double)>& progress) {
  schedule.apply(frame, features);
  const std::size_t n_queues = context.queues().size();
  const std::uint32_t rows = rows_per_band(frame, n_queues, kMaxFilmBytes);
  Frame shared{.bag = Bag(frame, rows),
               .image = {static_cast<int>(frame.width), static_cast<int>(frame.height),
                         std::vector<vec3>(std::size_t{frame.width} * frame.height)},
               .samples = static_cast<int>(frame.n_samples),
               .wait_mutex = {},
               .changed = {},
               .n_running = static_cast<std::uint32_t>(n_queues),
               .tiles_done = 0,
               .failed = false,
               .failure = nullptr};
  std::vector<std::unique_ptr<wavefront::Wavefront>> queues;
  for (const cl::CommandQueue& queue : context.queues())
    queues.push_back(std::make_unique<wavefront::Wavefront>(context, queue, scene, programs, frame, schedule,
                                                            features, shared.bag.largest_band_pixels()));

  Result result;
  const Timer timer;
  {
    std::vector<std::jthread> threads;
    for (const auto& queue : queues) threads.emplace_back([&shared, &queue] { run_queue(shared, *queue); });
    try {
      wait(shared, frame.n_tiles, progress);
    } catch (...) {
      shared.failed = true;  // the caller's progress threw: no more bands
      throw;
    }
  }
  if (shared.failure) std::rethrow_exception(shared.failure);
  result.render_seconds = timer.seconds();
  result.image = std::move(shared.image);
  for (const auto& queue : queues) {
    result.counters.add(queue->counters());
    for (const auto& [stage, seconds] : queue->stage_seconds()) result.stage_seconds[stage] += seconds;
    result.device_bytes += queue->device_bytes();
  }
  const std::uint32_t tile_rows = frame.n_tiles / frame.n_tiles_x;
  result.n_bands = (tile_rows + rows - 1) / rows;
  return result;
}

}  // namespace kdray::pdprt
