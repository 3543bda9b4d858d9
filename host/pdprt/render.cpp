#include "pdprt/render.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

#include "adaptive/sampler.h"
#include "base/raw_vector.h"
#include "base/timer.h"
#include "device/opencl_error.h"
#include "ledger/render_round.h"
#include "pdprt/queue.h"
#include "wavefront/bands.h"
#include "wavefront/curve.h"
#include "wavefront/develop.h"

namespace kdray::pdprt {

namespace {

constexpr double kForever = 1e9;  // seconds

class Frame {
 public:
  Frame(std::span<const Device> devices, const Task& task);
  Result render();

 private:
  struct Place {  // of a queue, whether it works or not
    std::unique_ptr<Queue> queue;
    QueueResult result;
  };

  void open(const Device& device, std::size_t number_of_device);
  void render_uniform();
  void render_adaptive();
  void render_bands();
  void render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  void render_runs(std::size_t first, std::span<const layout::u32> samples, std::span<layout::i64> sums,
                   const std::function<void(const Work&)>& render);
  void render_kept_uniform();
  void render_kept_tiles(std::span<layout::i64> sums);
  void render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  std::vector<layout::u32> render_list(std::vector<layout::u32> list, const Work& work,
                                       double seconds = kForever);
  void run(std::size_t number, Tiles& tiles, const Work& work);
  void leave_out(std::size_t number);
  void wait(Tiles& tiles, double seconds);
  void tell_progress() const;
  std::size_t n_working() const;
  Result collect(double seconds);

  const Task& task_;
  layout::Frame frame_;
  std::vector<wavefront::Band> bands_;
  wavefront::Room room_;
  film::Image image_;
  std::optional<adaptive::Sampler> sampler_;  // adaptive sampling
  Shared shared_;
  double progress_from_ = 0, progress_to_ = 1;  // of the share done: what the tiles of shared_.tiles_done are
  std::uint64_t n_tiles_ = 0;                   // of them all
  std::uint32_t n_rounds_ = 1;                  // that were begun, of a frame with a ledger
  std::vector<Place> places_;
  std::exception_ptr last_failure_;  // of a queue
  std::mutex mutex_;                 // of the following
  std::condition_variable changed_;
  std::size_t n_running_ = 0;
  std::exception_ptr fault_;  // for which no other queue may take over: ends the frame
};

Frame::Frame(std::span<const Device> devices, const Task& task) : task_(task), frame_(task.frame) {
  devices.front().schedule.apply(frame_, task.features);
  bands_ = wavefront::bands_of(frame_, task.max_film_bytes);
  const adaptive::Size size{frame_.width, frame_.height};
  image_ = {static_cast<int>(size.width), static_cast<int>(size.height), {}};
  if (task.adaptive_target > 0)
    sampler_.emplace(size, task.adaptive_target);
  else
    image_.pixels.resize(size.pixels());
  shared_.tile_queues.assign(frame_.n_tiles, kNobody);
  if (task.timeline) shared_.tile_seconds.resize(frame_.n_tiles);
  room_.tiles = std::size_t{bands_.front().n_rows} * frame_.n_tiles_x;
  room_.pixels = bands_.front().n_pixels;
  if (task.adaptive_target > 0)
    room_.samples = std::max(kLeastSamples, room_.pixels / KDRAY_SAMPLE_RUN * KDRAY_SAMPLE_RUN);
  std::size_t most = 0;
  for (const Device& device : devices) most = std::max(most, device.context->queues().size());
  for (std::size_t i = 0; i < most; ++i)  // in turn, as they were dealt out
    for (const Device& device : devices)
      if (i < device.context->queues().size()) open(device, i);
}

void Frame::open(const Device& device, std::size_t number_of_device) {
  const std::size_t number = places_.size();
  Place& place = places_.emplace_back();
  place.result.device = device.context->info().name;
  if (task_.timeline)
    task_.timeline->name_row(static_cast<int>(number),
                             "queue " + std::to_string(number) + ": " + place.result.device);
  try {
    place.queue =
        std::make_unique<Queue>(number, device, device.context->queues()[number_of_device], task_, room_);
  } catch (...) {
    leave_out(number);
  }
}

// From a handler of what the queue has thrown, which is thrown on where no other queue may take over.
void Frame::leave_out(std::size_t number) {
  const Error error = device::error_of_queue(std::current_exception(), "rendering");
  places_[number].result.failure = error.what();
  last_failure_ = std::make_exception_ptr(error);
}

std::size_t Frame::n_working() const {
  return static_cast<std::size_t>(std::count_if(places_.begin(), places_.end(), [](const Place& place) {
    return place.queue && place.result.failure.empty();
  }));
}

// Runs on a thread of the queue's own.
void Frame::run(std::size_t number, Tiles& tiles, const Work& work) {
  Place& place = places_[number];
  try {
    place.queue->serve(tiles, work, shared_);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    try {
      leave_out(number);
      place.queue->withdraw(shared_);
      place.result.tiles_lost = tiles.give_back(number);
    } catch (...) {
      fault_ = std::current_exception();
      tiles.leave();
    }
  }
  const std::lock_guard lock(mutex_);
  --n_running_;
  changed_.notify_one();
}

void Frame::tell_progress() const {
  if (!task_.progress) return;
  const std::uint64_t before = task_.ledger ? task_.ledger->n_present() : 0;
  const double share = static_cast<double>(before + shared_.tiles_done) / static_cast<double>(n_tiles_);
  task_.progress(progress_from_ + share * (progress_to_ - progress_from_));
}

// Reports progress from the calling thread until every queue's thread has ended, and closes the tiles when
// the time is over.
void Frame::wait(Tiles& tiles, double seconds) {
  constexpr double kStep = 0.01;
  const Timer timer;
  std::unique_lock lock(mutex_);
  while (n_running_ > 0) {
    const double left = std::max(seconds - timer.seconds(), 0.0);
    changed_.wait_for(lock, std::chrono::duration<double>(left > 0 ? std::min(left, kStep) : kStep));
    lock.unlock();
    if (left == 0) tiles.close();
    try {
      tell_progress();
    } catch (...) {
      tiles.leave();
      throw;
    }
    lock.lock();
  }
}

// Returns what nobody had begun when the time was over.
std::vector<layout::u32> Frame::render_list(std::vector<layout::u32> list, const Work& work, double seconds) {
  // A single queue takes everything at once.
  const Division division = places_.size() == 1 ? Division::contiguous : task_.division;
  Tiles tiles(std::move(list), division, places_.size(), task_.ledger != nullptr);
  n_running_ = n_working();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i].result.failure.empty())
        threads.emplace_back([this, i, &tiles, &work] { run(i, tiles, work); });
      else
        tiles.give_back(i);
    }
    wait(tiles, seconds);
  }
  if (fault_) std::rethrow_exception(fault_);
  if (n_working() == 0) std::rethrow_exception(last_failure_);
  return tiles.left_over();
}

void Frame::render_bands() {
  shared_.tiles_done = 0;
  n_tiles_ = frame_.n_tiles;
  for (const wavefront::Band& band : bands_)
    render_list(wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows),
                {.first_pixel = band.first_pixel});
}

void Frame::render_uniform() {
  shared_.deliver = [&](const wavefront::FilmSums& film, std::span<const layout::u32> tiles) {
    wavefront::develop_tiles(film.sums, film.first, frame_, tiles, image_.pixels);
  };
  render_bands();
}

// The sums of all tiles, from the ledger or rendered, to where the picture's are.
void Frame::render_kept_tiles(std::span<layout::i64> sums) {
  shared_.deliver = [&](const wavefront::FilmSums& film, std::span<const layout::u32> tiles) {
    wavefront::copy_tiles(film.sums, film.first, frame_, tiles, sums);
  };
  n_tiles_ = frame_.n_tiles;
  const std::uint32_t n_rows = frame_.n_tiles / frame_.n_tiles_x, of_band = bands_.front().n_rows;
  ledger::render_round(
      *task_.ledger, ledger::round_of_tiles(frame_, wavefront::tile_curve(frame_.n_tiles_x, 0, n_rows), sums),
      {.number_of = [of_band](layout::u32 tile) { return std::size_t{KDRAY_TILE_ROW(tile) / of_band}; },
       .render =
           [this](std::size_t band, std::vector<layout::u32> tiles, double seconds) {
             shared_.tiles_done = 0;
             return render_list(std::move(tiles), {.first_pixel = bands_[band].first_pixel}, seconds);
           },
       .idle = [this] { shared_.tiles_done = 0, tell_progress(); }});
}

void Frame::render_kept_uniform() {
  RawVector<layout::i64> sums(3 * image_.pixels.size());  // each is written
  render_kept_tiles(sums);
  const std::span<const layout::i64> film = sums;
  wavefront::develop({&film, 1}, static_cast<int>(frame_.n_samples), image_.pixels);
}

// Renders runs that lie in one stretch of the list, from run `first` on: `render` gets what the queues need
// to know of them. Their sums are set, not added to: a queue may fail when it has delivered some.
void Frame::render_runs(std::size_t first, std::span<const layout::u32> samples, std::span<layout::i64> sums,
                        const std::function<void(const Work&)>& render) {
  constexpr std::size_t kWords = 2 * KDRAY_SAMPLE_RUN, kSums = 3 * KDRAY_SAMPLE_RUN;
  shared_.deliver = [&](const wavefront::FilmSums& film, std::span<const layout::u32> delivered) {
    for (const layout::u32 run : delivered) {
      const auto from = film.sums.subspan(run * kSums - 3 * film.first, kSums);
      std::copy(from.begin(), from.end(), sums.subspan((first + run) * kSums).begin());
    }
  };
  const std::size_t most = room_.samples / KDRAY_SAMPLE_RUN,
                    n = std::min(most, samples.size() / kWords - first);
  render({.samples = samples.subspan(first * kWords, n * kWords)});
}

// Renders as many runs at a time as the queues have room for.
void Frame::render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  shared_.tiles_done = 0;
  n_tiles_ = samples.size() / (2 * KDRAY_SAMPLE_RUN);
  for (std::size_t first = 0; first < n_tiles_; first += room_.samples / KDRAY_SAMPLE_RUN)
    render_runs(first, samples, sums, [&](const Work& work) {
      std::vector<layout::u32> runs(work.samples.size() / (2 * KDRAY_SAMPLE_RUN));
      std::iota(runs.begin(), runs.end(), 0u);
      render_list(std::move(runs), work);
    });
}

void Frame::render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  n_tiles_ = samples.size() / (2 * KDRAY_SAMPLE_RUN);
  const auto most = static_cast<layout::u32>(room_.samples / KDRAY_SAMPLE_RUN);
  const auto render = [&](std::size_t stretch, std::vector<layout::u32> runs, double seconds) {
    const auto first = static_cast<layout::u32>(stretch * most);
    shared_.tiles_done = 0;
    for (layout::u32& run : runs) run -= first;
    render_runs(first, samples, sums,
                [&](const Work& work) { runs = render_list(std::move(runs), work, seconds); });
    for (layout::u32& run : runs) run += first;
    return runs;
  };
  ledger::render_round(*task_.ledger, ledger::round_of_runs(n_rounds_++, n_tiles_, sums),
                       {.number_of = [most](layout::u32 run) { return std::size_t{run / most}; },
                        .render = render,
                        .idle = [this] { shared_.tiles_done = 0, tell_progress(); }});
}

void Frame::render_adaptive() {
  progress_to_ = 0.5;
  if (task_.ledger) {
    render_kept_tiles(sampler_->first_sums());
  } else {
    shared_.deliver = [&](const wavefront::FilmSums& film, std::span<const layout::u32> tiles) {
      wavefront::copy_tiles(film.sums, film.first, frame_, tiles, sampler_->first_sums());
    };
    render_bands();
  }
  std::vector<layout::i64> sums;
  for (auto samples = sampler_->next(); !samples.empty(); samples = sampler_->next()) {
    progress_from_ = progress_to_;  // how many rounds there will be is not known
    progress_to_ = (1 + progress_to_) / 2;
    sums.resize(samples.size() / 2 * 3);
    task_.ledger ? render_kept_samples(samples, sums) : render_samples(samples, sums);
    sampler_->take(sums);
  }
  image_.pixels = sampler_->picture();
}

Result Frame::collect(double seconds) {
  Result result;
  result.render_seconds = seconds;
  result.image = std::move(image_);
  if (sampler_) result.samples = sampler_->report();
  result.tile_width = frame_.tile_width;
  result.tile_height = frame_.tile_height;
  result.n_tiles = frame_.n_tiles;
  result.n_bands = static_cast<std::uint32_t>(bands_.size());
  result.tile_queues = std::move(shared_.tile_queues);
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
  for (const wavefront::Band& band : bands_)
    if (!shared_.tile_seconds.empty() && result.tile_cost.total > 0)
      for (const layout::u32 tile : wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows))
        result.tile_seconds.push_back(
            shared_.tile_seconds[KDRAY_TILE_ROW(tile) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tile)]);
  return result;
}

Result Frame::render() {
  if (n_working() == 0) std::rethrow_exception(last_failure_);
  const Timer timer;
  if (sampler_)
    render_adaptive();
  else
    task_.ledger ? render_kept_uniform() : render_uniform();
  const double seconds = timer.seconds();
  if (task_.progress) task_.progress(1.0);
  return collect(seconds);
}

}  // namespace

Result render(std::span<const Device> devices, const Task& task) {
  return Frame(devices, task).render();
}

}  // namespace kdray::pdprt
