#include "pdprt/render.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "base/timer.h"
#include "pdprt/queue.h"
#include "wavefront/curve.h"

namespace kdray::pdprt {

namespace {

// Whole rows of tiles that the queues render together.
struct Band {
  std::uint32_t first_row, n_rows;  // of tiles
};

std::vector<Band> bands_of(const layout::Frame& frame, std::size_t max_film_bytes) {
  const std::uint32_t n_rows = frame.n_tiles / frame.n_tiles_x;
  const std::size_t row_bytes = std::size_t{frame.tile_height} * frame.width * 3 * sizeof(layout::i64);
  const auto fitting =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(max_film_bytes / row_bytes, 1, n_rows));
  std::vector<Band> bands;
  for (std::uint32_t row = 0; row < n_rows; row += fitting)
    bands.push_back({row, std::min(fitting, n_rows - row)});
  return bands;
}

class Frame {
 public:
  Frame(std::span<const Device> devices, const Task& task);
  Result render();

 private:
  struct Place {  // of a queue, whether it works or not
    std::unique_ptr<Queue> queue;
    QueueResult result;
  };

  void open(const Device& device, std::size_t number_of_device, std::size_t max_tiles,
            std::size_t max_pixels);
  void render_band(const Band& band);
  void run(std::size_t number, Tiles& tiles, std::size_t first_pixel);
  void fail(std::size_t number, const Error& error);
  void wait(Tiles& tiles);
  std::size_t n_working() const;
  Result collect(double seconds);

  const Task& task_;
  layout::Frame frame_;
  std::vector<Band> bands_;
  Shared shared_;
  std::vector<Place> places_;
  std::exception_ptr last_failure_;  // of a queue
  std::mutex mutex_;                 // of the following
  std::condition_variable changed_;
  std::size_t n_running_ = 0;
  std::exception_ptr fault_;  // of kdray: ends the frame
};

Frame::Frame(std::span<const Device> devices, const Task& task) : task_(task), frame_(task.frame) {
  devices.front().schedule.apply(frame_, task.features);
  bands_ = bands_of(frame_, task.max_film_bytes);
  shared_.image = {static_cast<int>(frame_.width), static_cast<int>(frame_.height),
                   std::vector<vec3>(std::size_t{frame_.width} * frame_.height)};
  if (task.timeline) shared_.tile_seconds.resize(frame_.n_tiles);
  const std::size_t max_tiles = std::size_t{bands_.front().n_rows} * frame_.n_tiles_x;
  const std::size_t max_pixels =
      std::min<std::size_t>(std::size_t{bands_.front().n_rows} * frame_.tile_height, frame_.height) *
      frame_.width;
  std::size_t most = 0;
  for (const Device& device : devices) most = std::max(most, device.context->queues().size());
  for (std::size_t i = 0; i < most; ++i)  // in turn, as they were dealt out
    for (const Device& device : devices)
      if (i < device.context->queues().size()) open(device, i, max_tiles, max_pixels);
}

void Frame::open(const Device& device, std::size_t number_of_device, std::size_t max_tiles,
                 std::size_t max_pixels) {
  const std::size_t number = places_.size();
  Place& place = places_.emplace_back();
  place.result.device = device.context->info().name;
  if (task_.timeline)
    task_.timeline->name_row(static_cast<int>(number),
                             "queue " + std::to_string(number) + ": " + place.result.device);
  try {
    place.queue = std::make_unique<Queue>(number, device, device.context->queues()[number_of_device], task_,
                                          max_tiles, max_pixels);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::internal) throw;
    fail(number, error);
  }
}

// From a handler of `error`.
void Frame::fail(std::size_t number, const Error& error) {
  places_[number].result.failure = error.what();
  last_failure_ = std::current_exception();
}

std::size_t Frame::n_working() const {
  return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
    return place.queue && place.result.failure.empty();
  }));
}

// On a thread of the queue's own.
void Frame::run(std::size_t number, Tiles& tiles, std::size_t first_pixel) {
  Place& place = places_[number];
  try {
    place.queue->serve(tiles, first_pixel, shared_);
  } catch (const Error& error) {
    const std::lock_guard lock(mutex_);
    if (error.code() == ErrorCode::internal) {
      fault_ = std::current_exception();
      tiles.leave();
    } else {
      fail(number, error);
      place.queue->withdraw(shared_);
      place.result.tiles_lost = tiles.give_back(number);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    fault_ = std::current_exception();
    tiles.leave();
  }
  const std::lock_guard lock(mutex_);
  --n_running_;
  changed_.notify_one();
}

// Reports progress from the calling thread until every queue's thread has ended.
void Frame::wait(Tiles& tiles) {
  using namespace std::chrono_literals;
  std::unique_lock lock(mutex_);
  while (n_running_ > 0) {
    changed_.wait_for(lock, 100ms);
    if (!task_.progress) continue;
    lock.unlock();
    try {
      task_.progress(static_cast<double>(shared_.tiles_done) / frame_.n_tiles);
    } catch (...) {
      tiles.leave();
      throw;
    }
    lock.lock();
  }
}

void Frame::render_band(const Band& band) {
  // One queue takes all at once.
  const Division division = places_.size() == 1 ? Division::contiguous : task_.division;
  Tiles tiles(wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows), division, places_.size());
  const std::size_t first_pixel = std::size_t{band.first_row} * frame_.tile_height * frame_.width;
  n_running_ = n_working();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].result.failure.empty())
        threads.emplace_back([this, i, &tiles, first_pixel] { run(i, tiles, first_pixel); });
      else
        tiles.give_back(i);
    }
    wait(tiles);
  }
  if (fault_) std::rethrow_exception(fault_);
  if (n_working() == 0) std::rethrow_exception(last_failure_);
}

Result Frame::collect(double seconds) {
  Result result;
  result.render_seconds = seconds;
  result.image = std::move(shared_.image);
  result.tile_width = frame_.tile_width;
  result.tile_height = frame_.tile_height;
  result.n_tiles = frame_.n_tiles;
  result.n_bands = static_cast<std::uint32_t>(bands_.size());
  result.tile_cost.tile_pixels = std::uint64_t{frame_.tile_width} * frame_.tile_height;
  for (Place& place : places_) {
    if (place.queue) {
      const wavefront::Wavefront& wavefront = place.queue->wavefront();
      result.counters.add(wavefront.counters());
      for (const auto& [stage, time] : wavefront.stage_seconds()) result.stage_seconds[stage] += time;
      place.result.busy_seconds = wavefront.busy_seconds();
      place.result.rays = wavefront.counters().total();
      place.result.tiles = place.queue->tiles();
      place.result.device_bytes = wavefront.device_bytes();
      result.tile_cost.costliest = std::max(result.tile_cost.costliest, place.queue->tile_cost().costliest);
      result.tile_cost.total += place.queue->tile_cost().total;
    }
    result.queues.push_back(std::move(place.result));
  }
  for (const Band& band : bands_)
    if (!shared_.tile_seconds.empty() && result.tile_cost.total > 0)
      for (const layout::u32 tile : wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows))
        result.tile_seconds.push_back(
            shared_.tile_seconds[KDRAY_TILE_ROW(tile) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tile)]);
  return result;
}

Result Frame::render() {
  if (n_working() == 0) std::rethrow_exception(last_failure_);
  const Timer timer;
  for (const Band& band : bands_) render_band(band);
  const double seconds = timer.seconds();
  if (task_.progress) task_.progress(1.0);
  return collect(seconds);
}

}  // namespace

Result render(std::span<const Device> devices, const Task& task) {
  return Frame(devices, task).render();
}

}  // namespace kdray::pdprt
