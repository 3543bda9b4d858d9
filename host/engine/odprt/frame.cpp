#include "engine/odprt/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "base/peak_memory.h"
#include "base/raw_vector.h"
#include "base/timer.h"
#include "engine/adaptive/sampler.h"
#include "engine/checkpoint/render_round.h"
#include "engine/odprt/band.h"
#include "engine/odprt/queue_failure.h"
#include "engine/odprt/rank_lists.h"
#include "engine/odprt/rank_report.h"
#include "engine/odprt/replicate.h"
#include "engine/wavefront/curve.h"
#include "engine/wavefront/develop.h"

namespace kdray::odprt {

namespace {

void check(const Exchange& exchange) {
  std::vector<QueueFailure> failures;
  for (const auto& [queue, error] : exchange.failures())
    failures.push_back({queue, device::error_of_queue(error, "rendering")});
  if (!failures.empty()) throw QueueFailures(std::move(failures));
}

using wavefront::Films;

// `of_others`: of other ranks, if there are any.
void take_films(WorkerPool& pool, std::span<const layout::i64> of_others,
                const std::function<void(Films)>& take) {
  std::vector<std::span<const layout::i64>> films;
  if (!of_others.empty()) films.push_back(of_others);
  for (std::size_t q = 0; q < pool.workers.size(); ++q)
    films.push_back(on_queue(q, "reading the film", [&] { return pool.workers[q]->map_film(); }));
  take(films);
  for (std::size_t q = 0; q < pool.workers.size(); ++q)
    on_queue(q, "giving back the film", [&] { pool.workers[q]->unmap_film(); });
}

void add_counts(const std::vector<std::vector<std::uint64_t>>& from,
                std::vector<std::vector<std::uint64_t>>& to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    for (std::size_t k = 0; k < from[i].size(); ++k) to[i][k] += from[i][k];
}

void add_band(const WorkerPool& pool, const Exchange& exchange, Result& result) {
  add_counts(exchange.counts().rays, result.exchange.rays);
  add_counts(exchange.counts().shadow_rays, result.exchange.shadow_rays);
  for (const auto& worker : pool.workers) {
    for (const layout::Slice& slice : worker->slices()) result.counters.add(slice);
  }
}

void add_visits(const WorkerPool& pool, const Division& division, Result& result) {
  for (std::size_t q = 0; q < pool.workers.size(); ++q) {
    const std::vector<SubtreeUse> visits =
        on_queue(q, "reading the visits", [&] { return pool.workers[q]->visits(); });
    const std::vector<std::uint32_t> subtrees = division.subtrees_of(static_cast<std::uint32_t>(q));
    for (std::size_t i = 0; i < visits.size(); ++i) {
      result.visits[subtrees[i]].visits += visits[i].visits;
      result.visits[subtrees[i]].hits += visits[i].hits;
    }
  }
}

// Shares the time that the queues were busy out among the stages, by their cycles.
void share_out_seconds(const WorkerPool& pool, Result& result) {
  std::map<std::string, double> cycles;
  for (const auto& worker : pool.workers) worker->add_cycles(cycles);
  double busy = 0, sum = 0;
  for (const QueueReport& report : result.queues) busy += report.busy_seconds;
  for (const auto& [stage, n] : cycles) sum += n;
  if (sum == 0) return;
  for (const auto& [stage, n] : cycles) result.stage_seconds[stage] += busy * (n / sum);
}

// Of the queue that serves a part. A rank's queues have numbers one after the other; without ranks some may
// be left out.
std::uint32_t number_of(const WorkerPool& pool, const RankTable& table, std::uint32_t part) {
  const std::size_t queue = pool.owner[part];
  return static_cast<std::uint32_t>(table.ranks ? queue : pool.reports[queue].number);
}

void finish(WorkerPool& pool, const RankTable& table, const Division& division, Result& result) {
  for (std::size_t q = 0; q < pool.workers.size(); ++q) {
    QueueReport& report = pool.reports[q];
    report.busy_seconds =
        on_queue(q, "reading the queue's clock", [&] { return pool.workers[q]->busy_seconds(); });
    report.n_loads = pool.stores[q]->n_loads();
    report.geometry_bytes = pool.stores[q]->bytes();
    result.counters.waves += report.waves;
    for (std::uint32_t part = 0; part < pool.owner.size(); ++part) {
      if (pool.owner[part] != table.own_first() + q) continue;
      ++report.n_parts;
      report.n_subtrees += static_cast<std::uint32_t>(division.subtrees_of(part).size());
    }
  }
  for (const std::uint32_t part : division.part_of)
    result.subtree_queues.push_back(part == kEveryPart ? kEveryPart : number_of(pool, table, part));
  result.queues = pool.reports;
  share_out_seconds(pool, result);
}

// Renders one frame, band by band.
class FrameRun {
 public:
  FrameRun(const Request& request, const Provision& provision, const Division& division, WorkerPool& pool,
           Result& result)
      : request_(request), provision_(provision), division_(division), pool_(pool), result_(result) {}

  void render_uniform();
  void render_kept_uniform();
  void render_adaptive();
  void render_for_rank_0();

 private:
  void render_bands(const std::function<void(const wavefront::Band&, Films)>& take);
  void render_kept_tiles(std::span<layout::i64> sums);
  void render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  std::vector<layout::u32> render_tiles(const wavefront::Band& band, std::span<const layout::u32> tiles,
                                        double seconds, std::span<layout::i64> sums);
  std::vector<layout::u32> render_runs(std::size_t first, std::span<const layout::u32> runs, double seconds,
                                       std::span<const layout::u32> samples, std::span<layout::i64> sums);
  void tell(double share_of_round) const;
  double share_present() const;
  void render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums);
  BandWork work_of(const ListHead& list, std::span<const layout::u32> entries,
                   std::span<const layout::u32> samples = {});
  Assignment assign_entries(const ListHead& list, std::span<const layout::u32> entries) const;
  std::function<bool(layout::u32)> entry_test(const ListHead& list) const;
  void check_list(const List& list) const;
  void render(BandWork& work, double from, double to, const std::function<void(Films)>& take);
  void run(BandWork& work, double from, double to);

  const Request& request_;
  const Provision& provision_;
  const Division& division_;
  WorkerPool& pool_;
  Result& result_;
  double from_ = 0, to_ = 1;    // of the share done, that the round in work is
  std::uint32_t n_rounds_ = 1;  // that were begun, of a frame with a checkpoint
};

// Which entries a list may have.
std::function<bool(layout::u32)> FrameRun::entry_test(const ListHead& list) const {
  if (list.of_runs) return [n = list.n_places / KDRAY_SAMPLE_RUN](layout::u32 run) { return run < n; };
  const layout::Frame& frame = provision_.frame;
  const auto first_row = static_cast<std::uint32_t>(list.first_pixel / frame.width / frame.tile_height);
  const auto n_rows =
      static_cast<std::uint32_t>((list.n_places / frame.width + frame.tile_height - 1) / frame.tile_height);
  return [=, n_tiles_x = frame.n_tiles_x](layout::u32 tile) {
    return KDRAY_TILE_COLUMN(tile) < n_tiles_x && KDRAY_TILE_ROW(tile) - first_row < n_rows;
  };
}

Assignment FrameRun::assign_entries(const ListHead& list, std::span<const layout::u32> entries) const {
  const std::size_t n_queues = request_.table.n_queues();
  const Assignment all =
      list.of_runs ? share_evenly(entries, n_queues)
                   : share_by_part(entries, n_queues, provision_.frame, division_.directory, pool_.owner);
  return request_.table.ranks ? of_rank(all, request_.table) : all;
}

// Of `samples` where there are any, else of tiles. Rank 0 tells the others.
BandWork FrameRun::work_of(const ListHead& list, std::span<const layout::u32> entries,
                           std::span<const layout::u32> samples) {
  const RankTable& table = request_.table;
  return {.list = table.ranks && table.leads() ? begin_list(*table.ranks, list, entries, samples) : list.list,
          .n_entries = entries.size(),
          .shares = Shares(assign_entries(list, entries)),
          .first_pixel = list.first_pixel,
          .n_places = list.n_places,
          .samples = samples,
          .is_entry = entry_test(list)};
}

// `from`, `to`: of the round.
void FrameRun::run(BandWork& work, double from, double to) {
  BandRun run(request_, pool_, work);
  const auto progress = [&](double share) { tell(from + (to - from) * share); };
  run.run(request_.progress ? progress : std::function<void(double)>());
  check(run.exchange());
  add_band(pool_, run.exchange(), result_);
}

void FrameRun::render(BandWork& work, double from, double to, const std::function<void(Films)>& take) {
  run(work, from, to);
  std::vector<layout::i64> of_others;
  if (request_.table.ranks) {
    of_others.resize(3 * work.n_places);
    gather_sums(*request_.table.ranks, work.list, of_others, work.left);
  }
  take_films(pool_, of_others, take);
  if (request_.census_every > 0) add_visits(pool_, division_, result_);
}

// What rank 0 begins has to fit this rank's capacity.
void FrameRun::check_list(const List& list) const {
  const ListHead& head = list.head;
  const std::size_t n_words = head.of_runs ? 2 * head.n_places : 0;
  if (head.n_places > provision_.capacity.places || head.n_entries > provision_.capacity.entries ||
      list.samples.size() != n_words || !std::ranges::all_of(list.entries, entry_test(head)))
    throw Error(ErrorCode::internal, "rank 0 has cut the picture otherwise than this rank");
}

void FrameRun::render_for_rank_0() {
  transport::Ranks& ranks = *request_.table.ranks;
  while (const std::optional<List> list = next_list(ranks)) {
    check_list(*list);
    BandWork work = work_of(list->head, list->entries, list->samples);
    run(work, 0, 1);
    std::vector<layout::i64> sums(3 * work.n_places);
    take_films(pool_, {}, [&](Films films) { wavefront::add_up(films, sums); });
    send_sums(ranks, work.list, sums, work.left);
  }
}

void FrameRun::render_bands(const std::function<void(const wavefront::Band&, Films)>& take) {
  const auto n_bands = static_cast<double>(provision_.bands.size());
  double done = 0;
  for (const wavefront::Band& band : provision_.bands) {
    const auto tiles = wavefront::tile_curve(provision_.frame.n_tiles_x, band.first_row, band.n_rows);
    BandWork work = work_of({.first_pixel = band.first_pixel, .n_places = band.n_pixels}, tiles);
    render(work, done / n_bands, (done + 1) / n_bands, [&](Films films) { take(band, films); });
    ++done;
  }
}

void FrameRun::render_uniform() {
  const auto samples = static_cast<int>(provision_.frame.n_samples);
  render_bands([&](const wavefront::Band& band, Films films) {
    wavefront::develop(films, samples,
                       std::span(result_.image.pixels).subspan(band.first_pixel, band.n_pixels));
  });
}

void FrameRun::tell(double share_of_round) const {
  if (request_.progress) request_.progress(from_ + (to_ - from_) * share_of_round);
}

double FrameRun::share_present() const {
  const auto n = static_cast<double>(std::max<std::size_t>(request_.checkpoint->n_entries(), 1));
  return static_cast<double>(request_.checkpoint->n_present()) / n;
}

// Tiles of a band, whose film is cleared and read as a whole. Returns those that were not begun.
std::vector<layout::u32> FrameRun::render_tiles(const wavefront::Band& band,
                                                std::span<const layout::u32> tiles, double seconds,
                                                std::span<layout::i64> sums) {
  BandWork work = work_of({.first_pixel = band.first_pixel, .n_places = band.n_pixels}, tiles);
  work.seconds = seconds;
  const double share = share_present();
  std::vector<layout::i64> of_band(3 * band.n_pixels);
  render(work, share, share, [&](Films films) { wavefront::add_up(films, of_band); });
  std::vector<layout::u32> left = work.left;
  std::ranges::sort(left);
  std::vector<layout::u32> done;
  std::ranges::copy_if(tiles, std::back_inserter(done),
                       [&](layout::u32 tile) { return !std::ranges::binary_search(left, tile); });
  wavefront::copy_tiles(of_band, band.first_pixel, provision_.frame, done, sums);
  return left;
}

// The sums of all tiles, from the checkpoint or rendered, to where the picture's are.
void FrameRun::render_kept_tiles(std::span<layout::i64> sums) {
  const layout::Frame& frame = provision_.frame;
  const std::uint32_t of_band = provision_.bands.front().n_rows;
  checkpoint::render_round(
      *request_.checkpoint,
      checkpoint::round_of_tiles(
          frame, wavefront::tile_curve(frame.n_tiles_x, 0, frame.n_tiles / frame.n_tiles_x), sums),
      {.number_of = [of_band](layout::u32 tile) { return std::size_t{KDRAY_TILE_ROW(tile) / of_band}; },
       .render = [&](std::size_t band, const std::vector<layout::u32>& tiles,
                     double seconds) { return render_tiles(provision_.bands[band], tiles, seconds, sums); },
       .idle = [this] { tell(share_present()); }});
}

void FrameRun::render_kept_uniform() {
  RawVector<layout::i64> sums(3 * result_.image.pixels.size());  // each is written
  render_kept_tiles(sums);
  const std::span<const layout::i64> film = sums;
  wavefront::develop({&film, 1}, static_cast<int>(provision_.frame.n_samples), result_.image.pixels);
}

// Runs of one stretch of the list, which begins with run `first`. Returns those that were not begun.
std::vector<layout::u32> FrameRun::render_runs(std::size_t first, std::span<const layout::u32> runs,
                                               double seconds, std::span<const layout::u32> samples,
                                               std::span<layout::i64> sums) {
  constexpr std::size_t kWords = 2 * KDRAY_SAMPLE_RUN, kSums = 3 * KDRAY_SAMPLE_RUN;
  const auto begin = static_cast<layout::u32>(first);
  const std::size_t most = provision_.capacity.samples / KDRAY_SAMPLE_RUN;
  const std::size_t n = std::min(most, samples.size() / kWords - first);
  std::vector<layout::u32> in_stretch;
  for (const layout::u32 run : runs) in_stretch.push_back(run - begin);
  BandWork work = work_of({.of_runs = 1, .n_places = n * KDRAY_SAMPLE_RUN}, in_stretch,
                          samples.subspan(first * kWords, n * kWords));
  work.seconds = seconds;
  const double share = share_present();
  std::vector<layout::i64> of_stretch(n * kSums);
  render(work, share, share, [&](Films films) { wavefront::add_up(films, of_stretch); });
  for (const layout::u32 run : in_stretch) {
    const auto from = std::span(of_stretch).subspan(run * kSums, kSums);
    std::ranges::copy(from, sums.subspan((first + run) * kSums).begin());  // 0 of those that are left
  }
  for (layout::u32& run : work.left) run += begin;
  return work.left;
}

void FrameRun::render_kept_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  const std::size_t most = provision_.capacity.samples / KDRAY_SAMPLE_RUN;
  checkpoint::render_round(
      *request_.checkpoint,
      checkpoint::round_of_runs(n_rounds_++, samples.size() / (2 * KDRAY_SAMPLE_RUN), sums),
      {.number_of = [most](layout::u32 run) { return run / most; },
       .render = [&](std::size_t stretch, const std::vector<layout::u32>& runs,
                     double seconds) { return render_runs(stretch * most, runs, seconds, samples, sums); },
       .idle = [this] { tell(share_present()); }});
}

// Renders as many samples at a time as the queues' films have places for.
void FrameRun::render_samples(std::span<const layout::u32> samples, std::span<layout::i64> sums) {
  constexpr std::size_t kWords = 2 * KDRAY_SAMPLE_RUN;
  const std::size_t n_runs = samples.size() / kWords, most = provision_.capacity.samples / KDRAY_SAMPLE_RUN;
  const auto all = static_cast<double>(n_runs);
  for (std::size_t first = 0; first < n_runs; first += most) {
    const std::size_t n = std::min(most, n_runs - first), n_places = n * KDRAY_SAMPLE_RUN;
    std::vector<layout::u32> runs(n);
    std::iota(runs.begin(), runs.end(), 0u);
    BandWork work =
        work_of({.of_runs = 1, .n_places = n_places}, runs, samples.subspan(first * kWords, n * kWords));
    render(work, static_cast<double>(first) / all, static_cast<double>(first + n) / all, [&](Films films) {
      wavefront::add_up(films, sums.subspan(3 * first * KDRAY_SAMPLE_RUN, 3 * n_places));
    });
  }
}

void FrameRun::render_adaptive() {
  adaptive::Sampler sampler({provision_.frame.width, provision_.frame.height}, request_.adaptive_target,
                            (request_.features & KDRAY_FEATURES_NOISY) != 0);
  to_ = 0.5;
  if (request_.checkpoint)
    render_kept_tiles(sampler.first_sums());
  else
    render_bands([&](const wavefront::Band& band, Films films) {
      wavefront::add_up(films, sampler.first_sums().subspan(3 * band.first_pixel, 3 * band.n_pixels));
    });
  std::vector<layout::i64> sums;
  for (auto samples = sampler.next(); !samples.empty(); samples = sampler.next()) {
    from_ = to_;  // how many rounds there will be is not known
    to_ = (1 + to_) / 2;
    sums.resize(samples.size() / 2 * 3);
    request_.checkpoint ? render_kept_samples(samples, sums) : render_samples(samples, sums);
    sampler.take(sums);
  }
  result_.image.pixels = sampler.picture();
  result_.samples = sampler.report();
}

// Rank 0 gets what the others have done.
void share_reports(const RankTable& table, Result& result) {
  transport::Ranks& ranks = *table.ranks;
  result.peak_bytes.resize(table.place().ranks);
  result.peak_bytes[table.place().rank] = peak_bytes().value_or(0);
  if (!ranks.leads()) return ranks.send(0, kReport, to_report(result, table));
  result.queues.resize(table.n_queues());
  finish_lists(ranks, [&](const transport::Message& report) { add_report(report, table, result); });
}

}  // namespace

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut) {
  Result result;
  if (request.table.leads())
    result.image = {static_cast<int>(provision.frame.width), static_cast<int>(provision.frame.height),
                    std::vector<vec3>(std::size_t{provision.frame.width} * provision.frame.height)};
  result.exchange = ExchangeCounts(request.table.n_queues());
  result.n_bands = static_cast<std::uint32_t>(provision.bands.size());
  result.n_parts = provision.n_parts;
  result.n_cells = static_cast<std::uint32_t>(division.directory.size());
  WorkerPool pool = make_worker_pool(request, provision, division, cut);
  if (request.census_every > 0) result.visits.resize(cut.subtrees.size());
  load_parts(pool, request.table, provision);
  if (request.timeline)
    for (const QueueReport& report : pool.reports)
      request.timeline->name_row(static_cast<int>(report.number),
                                 fmt::format("queue {}: {}", report.number, report.device));
  const Timer timer;
  FrameRun run(request, provision, division, pool, result);
  if (!request.table.leads())
    run.render_for_rank_0();
  else if (request.adaptive_target > 0)
    run.render_adaptive();
  else
    request.checkpoint ? run.render_kept_uniform() : run.render_uniform();
  result.render_seconds = timer.seconds();
  finish(pool, request.table, division, result);
  if (request.table.ranks) share_reports(request.table, result);
  return result;
}

}  // namespace kdray::odprt
