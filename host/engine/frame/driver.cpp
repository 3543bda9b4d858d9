#include "engine/frame/driver.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <future>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "base/memory.h"
#include "base/timer.h"
#include "engine/adaptive/sampler.h"
#include "engine/wavefront/tile_order.h"

namespace kdray::frame {

namespace {

constexpr std::size_t kWordsOfRun = 2 * KDRAY_SAMPLE_RUN, kSumsOfRun = 3 * KDRAY_SAMPLE_RUN;
constexpr std::size_t kLeastTiles = 4, kLeastRuns = 64;  // of a chunk: 64 runs are 16384 samples

// What the films have places for at a time.
struct Stretch {
  Entries entries;        // numbered as in the round
  List list;              // without entries
  layout::u32 first = 0;  // run of the round, from which the list's are numbered
  Sink sink;
};

struct Round {
  std::vector<Stretch> stretches = {};
  std::function<std::size_t(layout::u32 entry)> stretch_of = {};
  checkpoint::Round kept = {};  // with a checkpoint
};

class Driver {
 public:
  Driver(Executor& executor, const Request& request, Result& result);

  void render() { sampler_ ? render_adaptive() : render_uniform(); }
  std::optional<adaptive::Report> samples() const;

 private:
  void render_uniform();
  void render_adaptive();
  Round round_of_tiles(const Sink& sink, std::span<layout::i64> sums) const;
  Round round_of_runs(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  void render_tiles(std::span<layout::i64> sums);
  void render(Round round);
  void render_all(const Round& round);
  void render_missing(Round& round);
  Entries render_some(const Stretch& stretch, Entries entries, double seconds);
  void tell(double n_of_list) const;

  Executor& executor_;
  const Request& request_;
  const layout::Frame& frame_;
  std::vector<float>& rgb_;
  std::shared_future<void> rgb_made_;         // before anything is written there
  std::optional<adaptive::Sampler> sampler_;  // adaptive sampling
  double from_ = 0, to_ = 1;                  // of the share done, that the round in work is
  std::size_t n_entries_ = 0, n_done_ = 0;    // of the round; before the list in work
  std::uint32_t n_rounds_ = 1;                // that were begun
};

// Does what values.resize(n) does. The pages are made by several threads: one takes 2 ms for 12 MB, in which
// a GPU renders a frame.
void make_values(std::vector<float>& values, std::size_t n) {
  constexpr std::size_t kPiece = std::size_t{1} << 19;  // values: 2 MiB
  values.reserve(n);
  prefer_large_pages(values.data(), n * sizeof(float));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kPiece), [&](const auto& range) {
    make_pages(values.data() + range.begin(), range.size() * sizeof(float));
  });
  values.resize(n);
}

Driver::Driver(Executor& executor, const Request& request, Result& result)
    : executor_(executor), request_(request), frame_(executor.frame()), rgb_(result.rgb) {
  const adaptive::Size size{frame_.width, frame_.height};
  result.width = size.width;
  result.height = size.height;
  if (request.adaptive_target > 0)
    sampler_.emplace(size, request.adaptive_target, (request.features & KDRAY_FEATURES_NOISY) != 0);
  else
    rgb_made_ = std::async(std::launch::async, [this, n = 3 * size.pixels()] { make_values(rgb_, n); });
}

std::optional<adaptive::Report> Driver::samples() const {
  return sampler_ ? std::optional(sampler_->report()) : std::nullopt;
}

void Driver::tell(double n_of_list) const {
  if (!request_.progress) return;
  const double share =
      (static_cast<double>(n_done_) + n_of_list) / static_cast<double>(std::max<std::size_t>(n_entries_, 1));
  request_.progress(from_ + (to_ - from_) * std::min(share, 1.0));
}

// `sums` are the picture's, for the checkpoint.
Round Driver::round_of_tiles(const Sink& sink, std::span<layout::i64> sums) const {
  const std::span<const wavefront::Band> bands = executor_.bands();
  Round round{.stretch_of = [of_band = bands.front().n_rows](layout::u32 tile) {
    return std::size_t{KDRAY_TILE_ROW(tile) / of_band};
  }};
  for (const wavefront::Band& band : bands) {
    Stretch& stretch = round.stretches.emplace_back();
    stretch.entries = wavefront::tile_curve(frame_.n_tiles_x, band.first_row, band.n_rows);
    stretch.list.first_place = band.first_pixel;
    stretch.list.n_places = band.n_pixels;
    stretch.sink = sink;
  }
  if (!request_.checkpoint) return round;
  const checkpoint::Cut cut{frame_.width, frame_.height, frame_.tile_width, frame_.tile_height};
  round.kept = {.entries = wavefront::tile_curve(frame_.n_tiles_x, 0, frame_.n_tiles / frame_.n_tiles_x),
                .places = [cut](layout::u32 tile) { return checkpoint::places_of(cut, 0, tile); },
                .pitch = frame_.width,
                .sums = sums,
                .least_chunk = kLeastTiles};
  return round;
}

Round Driver::round_of_runs(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  const std::size_t n_runs = samples.size() / kWordsOfRun, most = executor_.n_samples() / KDRAY_SAMPLE_RUN;
  Round round{.stretch_of = [most](layout::u32 run) { return run / most; }};
  for (std::size_t first = 0; first < n_runs; first += most) {
    const std::size_t n = std::min(most, n_runs - first);
    Stretch& stretch = round.stretches.emplace_back();
    stretch.first = static_cast<layout::u32>(first);
    stretch.entries.resize(n);
    std::iota(stretch.entries.begin(), stretch.entries.end(), stretch.first);
    stretch.list.n_places = n * KDRAY_SAMPLE_RUN;
    stretch.list.samples = samples.subspan(first * kWordsOfRun, n * kWordsOfRun);
    stretch.sink = [of_stretch = sums.subspan(first * kSumsOfRun, n * kSumsOfRun)](
                       const auto& films, auto runs) { wavefront::copy_runs(films, runs, of_stretch); };
  }
  const std::uint32_t number = n_rounds_++;
  round.kept = {.number = number,
                .entries = Entries(n_runs),
                .places = [number](layout::u32 run) { return checkpoint::places_of({}, number, run); },
                .sums = sums,
                .least_chunk = kLeastRuns};
  std::iota(round.kept.entries.begin(), round.kept.entries.end(), 0u);
  return round;
}

void Driver::render(Round round) {
  request_.checkpoint ? render_missing(round) : render_all(round);
}

void Driver::render_all(const Round& round) {
  n_entries_ = n_done_ = 0;
  for (const Stretch& stretch : round.stretches) n_entries_ += stretch.entries.size();
  for (const Stretch& stretch : round.stretches) {
    render_some(stretch, stretch.entries, kForever);
    n_done_ += stretch.entries.size();
  }
}

void Driver::render_missing(Round& round) {
  checkpoint::FrameCheckpoint& checkpoint = *request_.checkpoint;
  n_entries_ = round.kept.entries.size();
  checkpoint.begin(std::move(round.kept));
  const auto idle = [&] {  // others that share the checkpoint are waited for
    n_done_ = checkpoint.n_present();
    tell(0);
  };
  for (Entries wanted = checkpoint.next(idle); !wanted.empty(); wanted = checkpoint.next(idle)) {
    std::map<std::size_t, Entries> by_stretch;
    for (const layout::u32 entry : wanted) by_stretch[round.stretch_of(entry)].push_back(entry);
    for (const auto& [number, entries] : by_stretch) {
      n_done_ = checkpoint.n_present();
      Entries left = render_some(round.stretches[number], entries, checkpoint.seconds());
      const bool all = left.empty();
      checkpoint.keep(without(entries, std::move(left)));
      if (!all) break;  // the interval is over: what is next is asked anew
    }
  }
}

Entries Driver::render_some(const Stretch& stretch, Entries entries, double seconds) {
  List list = stretch.list;
  list.seconds = seconds;
  list.entries = std::move(entries);
  for (layout::u32& entry : list.entries) entry -= stretch.first;
  Entries left = executor_.render(std::move(list), stretch.sink, [this](double done) { tell(done); });
  for (layout::u32& entry : left) entry += stretch.first;
  return left;
}

void Driver::render_tiles(std::span<layout::i64> sums) {
  const Sink sink = [this, sums](const auto& films, auto tiles) {
    wavefront::copy_tiles(films, frame_, tiles, sums);
  };
  render(round_of_tiles(sink, sums));
}

void Driver::render_uniform() {
  // Without sums of the whole picture where nobody wants them.
  const Sink sink = [this](const auto& films, auto tiles) {
    rgb_made_.get();
    wavefront::develop_tiles(films, frame_, tiles, rgb_);
  };
  if (!request_.checkpoint) return render(round_of_tiles(sink, {}));
  rgb_made_.get();
  RawVector<layout::i64> sums(rgb_.size());  // each is written
  render_tiles(sums);
  const std::span<const layout::i64> film = sums;
  wavefront::develop({&film, 1}, static_cast<int>(frame_.n_samples), rgb_);
}

void Driver::render_adaptive() {
  to_ = 0.5;
  render_tiles(sampler_->first_sums());
  std::vector<layout::i64> sums;
  for (auto samples = sampler_->next(); !samples.empty(); samples = sampler_->next()) {
    from_ = to_;  // how many rounds there will be is not known
    to_ = (1 + to_) / 2;
    sums.resize(samples.size() / 2 * 3);
    render(round_of_runs(samples, sums));
    sampler_->take(sums);
  }
  rgb_ = sampler_->picture();
}

}  // namespace

void render_frame(Executor& executor, const Request& request, Result& result) {
  const layout::Frame& frame = executor.frame();
  result.tile_width = frame.tile_width;
  result.tile_height = frame.tile_height;
  result.n_tiles = frame.n_tiles;
  result.n_bands = static_cast<std::uint32_t>(executor.bands().size());
  if (!executor.leads()) {
    const Timer timer;
    executor.follow();
    result.render_seconds = timer.seconds();
    return;
  }
  Driver driver(executor, request, result);
  const Timer timer;
  driver.render();
  result.render_seconds = timer.seconds();
  result.samples = driver.samples();
  if (request.progress) request.progress(1.0);
}

}  // namespace kdray::frame
