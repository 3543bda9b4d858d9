// The rounds of adaptive sampling: lists of runs of samples.
#include <algorithm>
#include <numeric>
#include <utility>

#include "engine/checkpoint/render_round.h"
#include "engine/pdprt/frame.h"

namespace kdray::pdprt {

namespace {

constexpr std::size_t kWordsOfRun = 2 * KDRAY_SAMPLE_RUN, kSumsOfRun = 3 * KDRAY_SAMPLE_RUN;
constexpr double kNoLimit = 1e9;  // seconds

}  // namespace

// Runs that lie in one stretch of the list, which begins with run `first`; they are numbered from there.
// Their sums are set, not added to: a queue may fail when it has delivered some.
std::vector<layout::u32> Frame::render_runs(std::size_t first, std::vector<layout::u32> runs,
                                            std::span<const layout::u32> samples, std::span<layout::i64> sums,
                                            double seconds) {
  const Destination to{
      .own =
          [&](const wavefront::FilmSums& film, std::span<const layout::u32> delivered) {
            for (const layout::u32 run : delivered) {
              const auto from = film.sums.subspan(run * kSumsOfRun - 3 * film.first, kSumsOfRun);
              std::copy(from.begin(), from.end(), sums.subspan((first + run) * kSumsOfRun).begin());
            }
          },
      .of_others =
          [&](layout::u32 run, checkpoint::Sums from) {
            std::copy(from.begin(), from.end(), sums.subspan((first + run) * kSumsOfRun).begin());
          }};
  const std::size_t most = capacity_.samples / KDRAY_SAMPLE_RUN,
                    n = std::min(most, samples.size() / kWordsOfRun - first);
  return render_list(std::move(runs), {.samples = samples.subspan(first * kWordsOfRun, n * kWordsOfRun)}, to,
                     seconds);
}

// Renders as many runs at a time as the queues have room for.
void Frame::render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  pool_->shared().tiles_done = n_of_others_ = 0;
  n_tiles_ = samples.size() / kWordsOfRun;
  const std::size_t most = capacity_.samples / KDRAY_SAMPLE_RUN;
  for (std::size_t first = 0; first < n_tiles_; first += most) {
    std::vector<layout::u32> runs(std::min<std::size_t>(most, n_tiles_ - first));
    std::iota(runs.begin(), runs.end(), 0u);
    render_runs(first, std::move(runs), samples, sums, kNoLimit);
  }
}

void Frame::render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  n_tiles_ = samples.size() / kWordsOfRun;
  const auto most = static_cast<layout::u32>(capacity_.samples / KDRAY_SAMPLE_RUN);
  const auto render = [&](std::size_t stretch, std::vector<layout::u32> runs, double seconds) {
    const auto first = static_cast<layout::u32>(stretch * most);
    pool_->shared().tiles_done = n_of_others_ = 0;
    for (layout::u32& run : runs) run -= first;
    runs = render_runs(first, std::move(runs), samples, sums, seconds);
    for (layout::u32& run : runs) run += first;
    return runs;
  };
  checkpoint::render_round(*task_.checkpoint, checkpoint::round_of_runs(n_rounds_++, n_tiles_, sums),
                           {.number_of = [most](layout::u32 run) { return std::size_t{run / most}; },
                            .render = render,
                            .idle = [this] { idle(); }});
}

void Frame::render_adaptive() {
  progress_to_ = 0.5;
  render_sums_of_tiles(sampler_->first_sums());
  std::vector<layout::i64> sums;
  for (auto samples = sampler_->next(); !samples.empty(); samples = sampler_->next()) {
    progress_from_ = progress_to_;  // how many rounds there will be is not known
    progress_to_ = (1 + progress_to_) / 2;
    sums.resize(samples.size() / 2 * 3);
    task_.checkpoint ? render_kept_samples(samples, sums) : render_samples(samples, sums);
    sampler_->take(sums);
  }
  image_.pixels = sampler_->picture();
}

}  // namespace kdray::pdprt
