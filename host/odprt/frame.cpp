#include "odprt/frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/timer.h"
#include "device/opencl_error.h"
#include "odprt/band.h"
#include "odprt/develop.h"

namespace kdray::odprt {

namespace {

// What a device said of a queue; anything else is thrown.
QueueFailure failure_of(std::size_t queue, std::exception_ptr error) {
  try {
    std::rethrow_exception(error);
  } catch (const cl::Error& e) {
    const Error translated = device::translate(e, "rendering");
    return {queue, std::make_exception_ptr(translated), translated.what()};
  } catch (const Error& e) {
    if (e.code() != ErrorCode::no_device && e.code() != ErrorCode::out_of_memory) throw;
    return {queue, error, e.what()};
  }
}

void check(const Exchange& exchange) {
  std::vector<QueueFailure> failures;
  for (const auto& [queue, error] : exchange.failures()) failures.push_back(failure_of(queue, error));
  if (!failures.empty()) throw QueueFailures(std::move(failures));
}

void take_film(Crew& crew, const Band& band, const layout::Frame& frame, film::Image& image) {
  std::vector<std::span<const layout::i64>> films;
  for (std::size_t q = 0; q < crew.workers.size(); ++q) {
    try {
      films.push_back(crew.workers[q]->map_film());
    } catch (...) {
      throw QueueFailures({failure_of(q, std::current_exception())});
    }
  }
  develop(films, static_cast<int>(frame.n_samples),
          std::span(image.pixels).subspan(band.first_pixel, band.n_pixels));
  for (const auto& worker : crew.workers) worker->unmap_film();
}

void add_counts(const std::vector<std::vector<std::uint64_t>>& from,
                std::vector<std::vector<std::uint64_t>>& to) {
  for (std::size_t i = 0; i < from.size(); ++i)
    for (std::size_t k = 0; k < from.size(); ++k) to[i][k] += from[i][k];
}

void add_band(const Crew& crew, const Exchange& exchange, Result& result) {
  add_counts(exchange.counts().rays, result.exchange.rays);
  add_counts(exchange.counts().shadow_rays, result.exchange.shadow_rays);
  for (const auto& worker : crew.workers) {
    for (const layout::Slice& slice : worker->slices()) result.counters.add(slice);
  }
}

void add_visits(const Crew& crew, const Division& division, Result& result) {
  for (std::size_t q = 0; q < crew.workers.size(); ++q) {
    const std::vector<std::uint64_t> visits = crew.workers[q]->visits();
    const std::vector<std::uint32_t> subtrees = division.subtrees_of(static_cast<std::uint32_t>(q));
    for (std::size_t i = 0; i < visits.size(); ++i) result.visits[subtrees[i]] += visits[i];
  }
}

// Of the stages' cycles, and of the time that the queues were busy.
void share_out_seconds(const Crew& crew, Result& result) {
  std::map<std::string, double> cycles;
  for (const auto& worker : crew.workers) worker->add_cycles(cycles);
  double busy = 0, sum = 0;
  for (const QueueReport& report : result.queues) busy += report.busy_seconds;
  for (const auto& [stage, n] : cycles) sum += n;
  if (sum == 0) return;
  for (const auto& [stage, n] : cycles) result.stage_seconds[stage] += busy * (n / sum);
}

void finish(Crew& crew, const Division& division, Result& result) {
  for (std::size_t q = 0; q < crew.workers.size(); ++q) {
    QueueReport& report = crew.reports[q];
    report.busy_seconds = crew.workers[q]->busy_seconds();
    report.n_loads = crew.stores[q]->n_loads();
    report.geometry_bytes = crew.stores[q]->peak_bytes();
    result.counters.waves += report.waves;
    for (std::uint32_t part = 0; part < crew.owner.size(); ++part) {
      if (crew.owner[part] != q) continue;
      ++report.n_parts;
      report.n_subtrees += static_cast<std::uint32_t>(division.subtrees_of(part).size());
    }
  }
  result.queues = crew.reports;
  share_out_seconds(crew, result);
}

}  // namespace

Result render_frame(const Request& request, const Provision& provision, const Division& division,
                    const Cut& cut) {
  Result result;
  result.image = {static_cast<int>(provision.frame.width), static_cast<int>(provision.frame.height),
                  std::vector<vec3>(std::size_t{provision.frame.width} * provision.frame.height)};
  result.exchange = ExchangeCounts(request.queues.size());
  result.n_bands = static_cast<std::uint32_t>(provision.bands.size());
  result.n_parts = provision.n_parts;
  result.n_cells = static_cast<std::uint32_t>(division.directory.size());
  Crew crew = make_crew(request, provision, division, cut);
  if (request.census_every > 0) result.visits.resize(cut.subtrees.size());
  load_parts(crew, provision);
  if (request.timeline)
    for (const QueueReport& report : crew.reports)
      request.timeline->name_row(static_cast<int>(report.number),
                                 fmt::format("queue {}: {}", report.number, report.device));
  const Timer timer;
  for (std::size_t i = 0; i < provision.bands.size(); ++i) {
    BandRun run(request, crew);
    const auto progress = [&](double share) {
      request.progress((static_cast<double>(i) + share) / static_cast<double>(provision.bands.size()));
    };
    run.run(provision.bands[i], request.progress ? progress : std::function<void(double)>());
    check(run.exchange());
    take_film(crew, provision.bands[i], provision.frame, result.image);
    add_band(crew, run.exchange(), result);
    if (request.census_every > 0) add_visits(crew, division, result);
  }
  result.render_seconds = timer.seconds();
  device::checked("reading the queues' clocks", [&] { finish(crew, division, result); });
  return result;
}

}  // namespace kdray::odprt
