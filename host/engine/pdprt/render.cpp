#include "engine/pdprt/render.h"

#include <algorithm>
#include <utility>

#include "base/raw_vector.h"
#include "base/timer.h"
#include "engine/checkpoint/render_round.h"
#include "engine/pdprt/frame.h"
#include "engine/wavefront/curve.h"
#include "engine/wavefront/develop.h"

namespace kdray::pdprt {

namespace {

constexpr double kForever = 1e9;  // seconds

}  // namespace

Frame::Frame(std::span<const Device> devices, const Task& task) : task_(task), frame_(task.frame) {
  devices.front().schedule.apply(frame_, task.features);
  bands_ = wavefront::bands_of(frame_, task.max_film_bytes);
  const adaptive::Size size{frame_.width, frame_.height};
  image_ = {static_cast<int>(size.width), static_cast<int>(size.height), {}};
  const bool has_picture = !task.ranks || task.ranks->leads();
  if (task.adaptive_target > 0 && has_picture)
    sampler_.emplace(size, task.adaptive_target, (task.features & KDRAY_FEATURES_NOISY) != 0);
  if (task.adaptive_target == 0 && has_picture) image_.pixels.resize(size.pixels());
  capacity_.tiles = std::size_t{bands_.front().n_rows} * frame_.n_tiles_x;
  capacity_.pixels = bands_.front().n_pixels;
  if (task.adaptive_target > 0)
    capacity_.samples = std::max(kLeastSamples, capacity_.pixels / KDRAY_SAMPLE_RUN * KDRAY_SAMPLE_RUN);
  pool_.emplace(devices, task, capacity_);
  pool_->shared().tile_queues.assign(frame_.n_tiles, kNobody);
  if (task.timeline) pool_->shared().tile_seconds.resize(frame_.n_tiles);
  if (task.ranks && task.ranks->leads()) server_.emplace(*task.ranks, shared_frame(), hierarchy());
}

SharedFrame Frame::shared_frame() const {
  return {task_.shared_frame, frame_.width, frame_.height, frame_.tile_width, frame_.tile_height};
}

TileHierarchy Frame::hierarchy() const {
  return TileHierarchy(task_.ranks->size(), task_.ranks_to_a_bag);
}

void Frame::render_bands(const Destination& to) {
  pool_->shared().tiles_done = n_of_others_ = 0;
  n_tiles_ = frame_.n_tiles;
  for (const wavefront::Band& band : bands_)
    render_list(wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows),
                {.first_pixel = band.first_pixel}, to, kForever);
}

void Frame::render_uniform() {
  render_bands({.own = [&](const wavefront::FilmSums& film, std::span<const layout::u32> tiles) {
    wavefront::develop_tiles(film.sums, film.first, frame_, tiles, image_.pixels);
  }});
}

Frame::Destination Frame::to_picture(std::span<layout::i64> sums) const {
  return {.own =
              [this, sums](const wavefront::FilmSums& film, std::span<const layout::u32> tiles) {
                wavefront::copy_tiles(film.sums, film.first, frame_, tiles, sums);
              },
          .of_others =
              [this, sums](layout::u32 tile, checkpoint::Sums from) {
                const checkpoint::Rectangle r = shared_frame().places_of(false, tile);
                for (std::size_t row = 0; row < r.height;
                     ++row, from = from.subspan(std::size_t{3} * r.width))
                  std::copy_n(from.begin(), std::size_t{3} * r.width,
                              sums.subspan(3 * ((r.y + row) * frame_.width + r.x)).begin());
              }};
}

// The sums of all tiles, from the checkpoint or rendered, to where the picture's are.
void Frame::render_sums_of_tiles(std::span<layout::i64> sums) {
  const Destination to = to_picture(sums);
  if (!task_.checkpoint) return render_bands(to);
  n_tiles_ = frame_.n_tiles;
  const std::uint32_t n_rows = frame_.n_tiles / frame_.n_tiles_x, of_band = bands_.front().n_rows;
  checkpoint::render_round(
      *task_.checkpoint,
      checkpoint::round_of_tiles(frame_, wavefront::tile_curve(frame_.n_tiles_x, 0, n_rows), sums),
      {.number_of = [of_band](layout::u32 tile) { return std::size_t{KDRAY_TILE_ROW(tile) / of_band}; },
       .render =
           [&](std::size_t band, std::vector<layout::u32> tiles, double seconds) {
             pool_->shared().tiles_done = n_of_others_ = 0;
             return render_list(std::move(tiles), {.first_pixel = bands_[band].first_pixel}, to, seconds);
           },
       .idle = [this] { idle(); }});
}

void Frame::render_uniform_sums() {
  RawVector<layout::i64> sums(3 * image_.pixels.size());  // each is written
  render_sums_of_tiles(sums);
  const std::span<const layout::i64> film = sums;
  wavefront::develop({&film, 1}, static_cast<int>(frame_.n_samples), image_.pixels);
}

// Others that share the checkpoint are waited for.
void Frame::idle() {
  pool_->shared().tiles_done = n_of_others_ = 0;
  tell_progress();
}

void Frame::tell_progress() const {
  if (!task_.progress) return;
  const std::uint64_t before = task_.checkpoint ? task_.checkpoint->n_present() : 0;
  const std::uint64_t of_others = n_of_others_ + (server_ ? server_->n_rendered() : 0);
  const double share = static_cast<double>(before + of_others + pool_->shared().tiles_done) /
                       static_cast<double>(std::max<std::uint64_t>(n_tiles_, 1));
  task_.progress(progress_from_ + std::min(share, 1.0) * (progress_to_ - progress_from_));
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
  result.tile_queues = std::move(pool_->shared().tile_queues);
  result.tile_cost.tile_pixels = std::uint64_t{frame_.tile_width} * frame_.tile_height;
  pool_->collect(result);
  const std::vector<double>& costs = pool_->shared().tile_seconds;
  for (const wavefront::Band& band : bands_)
    if (!costs.empty() && result.tile_cost.total > 0)
      for (const layout::u32 tile : wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows))
        result.tile_seconds.push_back(
            costs[KDRAY_TILE_ROW(tile) * frame_.n_tiles_x + KDRAY_TILE_COLUMN(tile)]);
  return result;
}

Result Frame::render() {
  pool_->require_one();
  const Timer timer;
  if (sampler_)
    render_adaptive();
  else
    task_.checkpoint || task_.ranks ? render_uniform_sums() : render_uniform();
  const double seconds = timer.seconds();
  if (task_.progress) task_.progress(1.0);
  Result result = collect(seconds);
  if (server_) add_reports(result);
  return result;
}

Result render(std::span<const Device> devices, const Task& task) {
  Frame frame(devices, task);
  return task.ranks && !task.ranks->leads() ? frame.render_for_others() : frame.render();
}

}  // namespace kdray::pdprt
