#include "engine/pdprt/queue.h"

#include <algorithm>
#include <numeric>

#include "device/opencl/opencl_error.h"

namespace kdray::pdprt {

namespace {

// Shorter launches than this are not worth their report.
constexpr double kLeastOfGuess = 1.0 / 16;  // waves of a tile
constexpr double kShortestSeconds = 0.0003;

layout::Frame scheduled(layout::Frame frame, const wavefront::Schedule& schedule, layout::Features features) {
  schedule.apply(frame, features);
  return frame;
}

// Of a tile, when none has been rendered: as if each eye ray spawned one.
double guessed_waves(const layout::Frame& frame) {
  const double samples = static_cast<double>(frame.tile_width) * frame.tile_height * frame.n_samples;
  return 2 * samples / frame.batch_size;
}

constexpr double kWavesOfRun = 2.0 * KDRAY_SAMPLE_RUN;  // times rays in a batch, guessed in the same way

// What a queue delivers at once: neighbouring rows of tiles, or runs, and where their light is in the film.
struct Delivery {
  std::span<const layout::u32> entries;
  wavefront::FilmPiece film;
};

// Of entries from the first to the last, which are in order: the rows of the picture that tiles cover, or
// runs.
wavefront::FilmPiece film_of(layout::u32 first, layout::u32 last, const layout::Frame& frame,
                             bool are_tiles) {
  if (!are_tiles)
    return {std::size_t{first} * KDRAY_SAMPLE_RUN, std::size_t{last + 1 - first} * KDRAY_SAMPLE_RUN};
  const std::size_t first_row = std::size_t{KDRAY_TILE_ROW(first)} * frame.tile_height;
  const std::size_t end_row =
      std::min<std::size_t>((std::size_t{KDRAY_TILE_ROW(last)} + 1) * frame.tile_height, frame.height);
  return {first_row * frame.width, (end_row - first_row) * frame.width};
}

// Returns tiles in the order in which they lie in the picture. By marks, since sorting thousands of them took
// 2.4% of a small frame's processor time.
std::vector<layout::u32> in_rows(std::span<const layout::u32> tiles, const layout::Frame& frame) {
  std::vector<std::uint8_t> is_there(frame.n_tiles);
  for (const layout::u32 tile : tiles)
    is_there[KDRAY_TILE_ROW(tile) * frame.n_tiles_x + KDRAY_TILE_COLUMN(tile)] = 1;
  std::vector<layout::u32> in_order;
  in_order.reserve(tiles.size());
  for (layout::u32 i = 0; i < frame.n_tiles; ++i)
    if (is_there[i]) in_order.push_back(KDRAY_TILE(i % frame.n_tiles_x, i / frame.n_tiles_x));
  return in_order;
}

std::vector<layout::u32> sorted(std::span<const layout::u32> runs) {
  std::vector<layout::u32> in_order(runs.begin(), runs.end());
  std::ranges::sort(in_order);
  return in_order;
}

// Divides entries, which are in order, so that none of the film's pieces has more places than asked for, if a
// row of tiles has not.
std::vector<Delivery> deliveries_of(std::span<const layout::u32> entries, const layout::Frame& frame,
                                    bool are_tiles, std::size_t most_places) {
  std::vector<Delivery> all;
  const auto row = [&](layout::u32 entry) { return are_tiles ? KDRAY_TILE_ROW(entry) : entry; };
  for (std::size_t first = 0, i = 0; i < entries.size(); first = i) {
    while (i < entries.size() && (row(entries[i]) == row(entries[first]) ||
                                  film_of(entries[first], entries[i], frame, are_tiles).n <= most_places))
      ++i;
    all.push_back(
        {entries.subspan(first, i - first), film_of(entries[first], entries[i - 1], frame, are_tiles)});
  }
  return all;
}

}  // namespace

Queue::Queue(std::size_t number, const Device& device, const cl::CommandQueue& queue, const Task& task,
             const wavefront::Capacity& capacity)
    : number_(number),
      frame_(scheduled(task.frame, device.schedule, task.features)),
      n_slices_(device.schedule.slices()),
      waves_per_launch_(n_slices_ * (device.schedule.fused ? device.schedule.fused_waves : 1.0)),
      waves_per_tile_(guessed_waves(frame_)),
      compute_units_(device::checked(
          "asking for the queue's device",
          [&] { return queue.getInfo<CL_QUEUE_DEVICE>().getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>(); })),
      wavefront_(*device.context, queue, *device.scene, *device.programs, frame_, device.schedule,
                 task.features, capacity) {
  wavefront::Watch watch;
  if (task.fault_injector)
    watch.before = [injector = task.fault_injector, number] { injector->launch(number); };
  if (task.timeline) {
    device::checked("comparing clocks", [&] { clock_.emplace(device.context->get(), queue); });
    watch.after = [this, timeline = task.timeline](const wavefront::LaunchDone& done) {
      timeline->add(static_cast<int>(number_), "launch", timeline->seconds_at(clock_->on_host(done.start)),
                    timeline->seconds_at(clock_->on_host(done.end)),
                    {{"waves", static_cast<double>(done.waves)},
                     {"tiles", static_cast<double>(done.tiles)},
                     {"rays", static_cast<double>(done.rays)}});
    };
  }
  wavefront_.watch(std::move(watch));
}

std::optional<std::span<const layout::u32>> Queue::more(Tiles& tiles, const wavefront::Progress& progress,
                                                        const Work& work, Shared& shared) {
  if (tiles.left()) return std::nullopt;
  shared.tiles_done += progress.taken - n_told_;
  n_told_ = progress.taken;
  if (since_begin_.seconds() > work.seconds) return std::span<const layout::u32>();
  const std::size_t ahead = tiles.taken(number_).size() - progress.front;
  const bool measured = progress.taken > 0;
  if (measured)
    waves_per_tile_ = std::max(static_cast<double>(progress.waves) / progress.taken, least_waves_per_tile_);
  // The launch that is running takes as much as it can of what there is. The one to be queued is to find all
  // it can take, and more, when that is known: a slice that runs dry traces its last rays in batches that
  // aren't full.
  const std::size_t in_launch = std::min(ahead, tiles_of_launch());
  std::size_t most = (measured ? 2 : 1) * tiles_of_launch() + n_slices_ - 1;
  if (work.left_after < frame::kForever) {
    const std::size_t in_time =
        tiles_in_time(work.left_after, since_begin_.seconds(), progress.front, n_slices_);
    most = std::min(most, in_time - std::min(in_time, in_launch));
  }
  return tiles.take(number_, {.most = most, .least = shortest_launch(progress), .ahead = ahead - in_launch});
}

// In tiles, by the time that they have taken so far.
std::size_t Queue::shortest_launch(const wavefront::Progress& progress) const {
  const double busy = wavefront_.busy_seconds() - busy_before_;
  return busy > 0 ? static_cast<std::size_t>(kShortestSeconds / busy * progress.taken) + 1 : 1;
}

std::size_t Queue::tiles_of_launch() const {
  return static_cast<std::size_t>(waves_per_launch_ / waves_per_tile_) + 1;
}

void Queue::serve(Tiles& tiles, const Work& work, Shared& shared) {
  waves_per_tile_ = work.samples.empty() ? guessed_waves(frame_) : kWavesOfRun / frame_.batch_size;
  least_waves_per_tile_ = kLeastOfGuess * waves_per_tile_;
  while (tiles.wait(number_)) {
    n_told_ = 0;
    busy_before_ = wavefront_.busy_seconds();
    since_begin_.restart();
    work.samples.empty() ? wavefront_.begin(work.first_pixel) : wavefront_.begin_samples(work.samples);
    const auto feed = [&](const wavefront::Progress& progress) {
      return more(tiles, progress, work, shared);
    };
    if (!wavefront_.render(feed)) return;
    deliver(tiles.taken(number_), work, shared);
    tiles.done(number_);
  }
}

void Queue::deliver(std::span<const layout::u32> tiles, const Work& work, Shared& shared) {
  if (tiles.empty()) return wavefront_.finish();  // another queue was faster
  if (work.samples.empty()) note_costs(tiles, shared);
  const std::vector<layout::u32> in_order = work.samples.empty() ? in_rows(tiles, frame_) : sorted(tiles);
  const std::vector<Delivery> deliveries =
      deliveries_of(in_order, frame_, work.samples.empty(), wavefront_.film_piece());
  std::vector<wavefront::FilmPiece> pieces;
  for (const Delivery& delivery : deliveries) pieces.push_back(delivery.film);
  // Last: what it adds to the counters counts.
  wavefront_.finish(pieces, [&](std::size_t i, const wavefront::FilmSums& film) {
    work.sink({{&film.sums, 1}, film.first, frame_.width}, deliveries[i].entries);
  });
  if (work.samples.empty()) {
    n_tiles_ += tiles.size();
    for (const layout::u32 tile : tiles)
      shared.tile_queues[KDRAY_TILE_ROW(tile) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tile)] =
          static_cast<std::uint32_t>(number_);
  }
  shared.tiles_done += tiles.size() - n_told_;
  n_told_ = 0;
}

// The list's device time, shared out by the cycles that were charged to its tiles.
void Queue::note_costs(std::span<const layout::u32> tiles, Shared& shared) {
  const std::vector<layout::u64> cycles = wavefront_.tile_cycles();
  const double sum = std::accumulate(cycles.begin(), cycles.end(), 0.0);
  if (sum == 0) return;
  const double seconds = (wavefront_.busy_seconds() - busy_before_) * compute_units_;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const double cost = static_cast<double>(cycles[i]) * (seconds / sum);
    tile_cost_.costliest = std::max(tile_cost_.costliest, cost);
    if (!shared.tile_seconds.empty())
      shared.tile_seconds[KDRAY_TILE_ROW(tiles[i]) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tiles[i])] = cost;
  }
  tile_cost_.total += seconds;
}

void Queue::withdraw(Shared& shared) {
  shared.tiles_done -= n_told_;
  n_told_ = 0;
}

}  // namespace kdray::pdprt
