#include "engine/odprt/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <functional>

#include "base/process_memory.h"
#include "engine/frame/driver.h"
#include "engine/odprt/assign.h"
#include "engine/odprt/band.h"
#include "engine/odprt/rank_table.h"

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
  std::exception_ptr of_take;  // no queue's fault
  const auto take_all = [&] {
    try {
      take(films);
    } catch (...) {
      of_take = std::current_exception();
    }
  };
  // Each film is there while the next ones are read.
  const std::function<void(std::size_t)> read_from = [&](std::size_t q) {
    if (q == pool.workers.size()) return take_all();
    on_queue(q, "reading the film", [&] {
      pool.workers[q]->with_film([&](std::span<const layout::i64> film) {
        films.push_back(film);
        read_from(q + 1);
      });
    });
  };
  read_from(0);
  if (of_take) std::rethrow_exception(of_take);
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
  for (const auto& worker : pool.workers) worker->add_stages(cycles);
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
    result.counters.launches += report.launches;
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

class Executor final : public frame::Executor {
 public:
  Executor(const Request& request, const Provision& provision, const Division& division, WorkerPool& pool,
           Result& result)
      : request_(request), provision_(provision), division_(division), pool_(pool), result_(result) {}

  const layout::Frame& frame() const override { return provision_.frame; }
  std::span<const wavefront::Band> bands() const override { return provision_.bands; }
  std::size_t n_samples() const override { return provision_.capacity.samples; }
  frame::Entries render(frame::List list, const frame::Sink& sink,
                        const std::function<void(double)>& progress) override;
  bool leads() const override { return request_.table.leads(); }
  void follow() override;

 private:
  BandWork work_of(const ListHead& list, std::span<const layout::u32> entries,
                   std::span<const layout::u32> samples);
  Assignment assign_entries(const ListHead& list, std::span<const layout::u32> entries) const;
  std::function<bool(layout::u32)> entry_test(const ListHead& list) const;
  void check_list(const List& list) const;
  void run(BandWork& work, const std::function<void(double)>& progress);

  const Request& request_;
  const Provision& provision_;
  const Division& division_;
  WorkerPool& pool_;
  Result& result_;
};

// Which entries a list may have.
std::function<bool(layout::u32)> Executor::entry_test(const ListHead& list) const {
  if (list.of_runs) return [n = list.n_places / KDRAY_SAMPLE_RUN](layout::u32 run) { return run < n; };
  const layout::Frame& frame = provision_.frame;
  const auto first_row = static_cast<std::uint32_t>(list.first_pixel / frame.width / frame.tile_height);
  const auto n_rows =
      static_cast<std::uint32_t>((list.n_places / frame.width + frame.tile_height - 1) / frame.tile_height);
  return [=, n_tiles_x = frame.n_tiles_x](layout::u32 tile) {
    return KDRAY_TILE_COLUMN(tile) < n_tiles_x && KDRAY_TILE_ROW(tile) - first_row < n_rows;
  };
}

Assignment Executor::assign_entries(const ListHead& list, std::span<const layout::u32> entries) const {
  const std::size_t n_queues = request_.table.n_queues();
  const Assignment all =
      list.of_runs ? share_evenly(entries, n_queues)
                   : share_by_part(entries, n_queues, provision_.frame, division_.directory, pool_.owner);
  return request_.table.ranks ? of_rank(all, request_.table) : all;
}

// Of `samples` where there are any, else of tiles. Rank 0 tells the others.
BandWork Executor::work_of(const ListHead& list, std::span<const layout::u32> entries,
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

void Executor::run(BandWork& work, const std::function<void(double)>& progress) {
  BandRun run(request_, pool_, work);
  run.run(progress);
  check(run.exchange());
  add_band(pool_, run.exchange(), result_);
}

frame::Entries Executor::render(frame::List list, const frame::Sink& sink,
                                const std::function<void(double)>& progress) {
  BandWork work =
      work_of({.of_runs = list.has_runs(), .first_pixel = list.first_place, .n_places = list.n_places},
              list.entries, list.samples);
  work.seconds = list.seconds;
  // How many will be left when the time is over can't be told before.
  const bool all = list.seconds >= frame::kForever;
  run(work, [&](double share) { progress(all ? share * static_cast<double>(list.entries.size()) : 0); });
  std::vector<layout::i64> of_others;
  if (request_.table.ranks) {
    of_others.resize(3 * work.n_places);
    gather_sums(*request_.table.ranks, work.list, of_others, work.left);
  }
  const frame::Entries done = frame::without(std::move(list.entries), work.left);
  take_films(pool_, of_others, [&](Films films) { sink({films, list.first_place, frame().width}, done); });
  if (request_.census_every > 0) add_visits(pool_, division_, result_);
  return work.left;
}

// What rank 0 begins has to fit this rank's capacity.
void Executor::check_list(const List& list) const {
  const ListHead& head = list.head;
  const std::size_t n_words = head.of_runs ? 2 * head.n_places : 0;
  if (head.n_places > provision_.capacity.places || head.n_entries > provision_.capacity.entries ||
      list.samples.size() != n_words || !std::ranges::all_of(list.entries, entry_test(head)))
    throw Error(ErrorCode::internal, "rank 0 has cut the picture otherwise than this rank");
}

void Executor::follow() {
  transport::Ranks& ranks = *request_.table.ranks;
  while (const std::optional<List> list = next_list(ranks)) {
    check_list(*list);
    BandWork work = work_of(list->head, list->entries, list->samples);
    run(work, {});
    std::vector<layout::i64> sums(3 * work.n_places);
    take_films(pool_, {}, [&](Films films) { wavefront::add_up(films, sums); });
    send_sums(ranks, work.list, sums, work.left);
  }
}

// The fields of a queue that travel to rank 0.
template <class Stream, class Queue>
void pass(Stream& stream, Queue& queue) {
  frame::pass_queue(stream, queue);
  stream(queue.launches, queue.waves, queue.n_parts, queue.n_subtrees, queue.n_loads, queue.geometry_bytes);
}

// And what it has sent.
template <class Stream, class Exchange>
void pass(Stream& stream, Exchange& exchange, std::size_t queue) {
  for (auto& n : exchange.rays[queue]) stream(n);
  for (auto& n : exchange.shadow_rays[queue]) stream(n);
}

transport::Bytes to_report(const Result& result, const RankTable& table) {
  transport::Writer writer;
  frame::put_share(result, writer);
  writer(result.peak_bytes[table.place().rank]);
  for (std::size_t q = 0; q < table.n_own(); ++q) {
    pass(writer, result.queues[q]);
    pass(writer, result.exchange, table.own_first() + q);
  }
  return writer.take();
}

void add_report(const transport::Message& message, const RankTable& table, Result& result) {
  transport::Reader reader(message);
  frame::add_share(reader, result);
  const auto from = static_cast<std::size_t>(message.from);
  reader(result.peak_bytes[from]);
  for (std::size_t q = table.first[from]; q < table.first[from + 1]; ++q) {
    pass(reader, result.queues[q]);
    result.queues[q].number = q;
    result.queues[q].rank = message.from;
    pass(reader, result.exchange, q);
  }
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
  result.exchange = ExchangeCounts(request.table.n_queues());
  result.n_parts = provision.n_parts;
  result.per_ray = provision.plan.per_ray;
  result.n_cells = static_cast<std::uint32_t>(division.directory.size());
  WorkerPool pool = make_worker_pool(request, provision, division, cut);
  if (request.census_every > 0) result.visits.resize(cut.subtrees.size());
  load_parts(pool, request.table, provision);
  if (request.timeline)
    for (const QueueReport& report : pool.reports)
      request.timeline->name_row(static_cast<int>(report.number),
                                 fmt::format("queue {}: {}", report.number, report.device));
  Executor executor(request, provision, division, pool, result);
  frame::render_frame(executor, request, result);
  finish(pool, request.table, division, result);
  if (request.table.ranks) share_reports(request.table, result);
  return result;
}

}  // namespace kdray::odprt
