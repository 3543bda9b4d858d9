#include "engine/odprt/crew.h"

#include <algorithm>

#include "engine/odprt/queue_failure.h"

namespace kdray::odprt {

namespace {

std::size_t largest_part(const Division& division) {
  std::size_t most = 0;
  for (std::uint32_t part = 0; part < division.parts.size(); ++part)
    most = std::max(most, division.subtrees_of(part).size());
  return most;
}

void add_worker(const Request& request, const Provision& provision, const Division& division, const Cut& cut,
                const Queue& queue, Crew& crew) {
  crew.workers.push_back(std::make_unique<Worker>(
      *queue.context, queue.queue, *queue.programs, provision.frame, provision.plan, request.features,
      request.traversal, division.directory, provision.room, largest_part(division)));
  crew.stores.push_back(
      std::make_unique<PartStore>(*queue.context, queue.queue, division, cut, provision.streamed));
  crew.outboxes.emplace_back();
  for (std::size_t i = 0; i < provision.n_outboxes; ++i)
    crew.outboxes.back().push_back(std::make_unique<Outbox>(*queue.context, provision.plan.outbox));
  QueueReport report;
  report.number = queue.number;
  report.device = queue.context->info().name;
  report.work_bytes =
      crew.workers.back()->bytes() + provision.n_outboxes * crew.outboxes.back().front()->bytes();
  crew.reports.push_back(report);
}

}  // namespace

Crew make_crew(const Request& request, const Provision& provision, const Division& division, const Cut& cut) {
  Crew crew;
  crew.plan = provision.plan;
  for (std::size_t q = 0; q < request.queues.size(); ++q)
    on_queue(q, "setting up the queues",
             [&] { add_worker(request, provision, division, cut, request.queues[q], crew); });
  for (std::uint32_t part = 0; part < provision.n_parts; ++part)
    crew.owner.push_back(part % request.table.n_queues());
  crew.direct.resize(crew.workers.size());
  for (std::size_t q = 0; q < crew.workers.size(); ++q)
    for (std::uint32_t part = 0; part < provision.n_parts; ++part)
      crew.direct[q].push_back(provision.plan.outbox.n_places > 1 && request.table.is_own(crew.owner[part]) &&
                               request.queues[q].context ==
                                   request.queues[crew.owner[part] - request.table.own_first()].context);
  return crew;
}

void load_parts(Crew& crew, const RankTable& table, const Provision& provision) {
  if (provision.streamed) return;
  for (std::uint32_t part = 0; part < crew.owner.size(); ++part) {
    if (!table.is_own(crew.owner[part])) continue;
    const std::size_t q = crew.owner[part] - table.own_first();
    on_queue(q, "loading the parts of the scene",
             [&] { crew.workers[q]->warm_up(crew.stores[q]->get(part), *crew.outboxes[q].front()); });
  }
}

}  // namespace kdray::odprt
