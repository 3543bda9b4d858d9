#include "engine/odprt/worker_pool.h"

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
                const Queue& queue, WorkerPool& pool) {
  pool.workers.push_back(std::make_unique<Worker>(
      *queue.context, queue.queue, *queue.programs, provision.frame, provision.plan, request.features,
      request.traversal, queue.work_group, division.directory, provision.capacity, largest_part(division)));
  pool.stores.push_back(std::make_unique<PartStore>(*queue.context, queue.queue, division, cut,
                                                    provision.streamed, provision.plan.per_ray));
  pool.outboxes.emplace_back();
  for (std::size_t i = 0; i < provision.n_outboxes; ++i)
    pool.outboxes.back().push_back(std::make_unique<Outbox>(*queue.context, provision.plan.outbox));
  QueueReport report;
  report.number = queue.number;
  report.device = queue.context->info().name;
  report.device_bytes =
      pool.workers.back()->bytes() + provision.n_outboxes * pool.outboxes.back().front()->bytes();
  pool.reports.push_back(report);
}

}  // namespace

WorkerPool make_worker_pool(const Request& request, const Provision& provision, const Division& division,
                            const Cut& cut) {
  WorkerPool pool;
  pool.plan = provision.plan;
  for (std::size_t q = 0; q < request.queues.size(); ++q)
    on_queue(q, "setting up the queues",
             [&] { add_worker(request, provision, division, cut, request.queues[q], pool); });
  for (std::uint32_t part = 0; part < provision.n_parts; ++part)
    pool.owner.push_back(part % request.table.n_queues());
  pool.direct.resize(pool.workers.size());
  for (std::size_t q = 0; q < pool.workers.size(); ++q)
    for (std::uint32_t part = 0; part < provision.n_parts; ++part)
      pool.direct[q].push_back(provision.plan.outbox.n_places > 1 && request.table.is_own(pool.owner[part]) &&
                               request.queues[q].context ==
                                   request.queues[pool.owner[part] - request.table.own_first()].context);
  return pool;
}

void load_parts(WorkerPool& pool, const RankTable& table, const Provision& provision) {
  if (provision.streamed) return;
  for (std::uint32_t part = 0; part < pool.owner.size(); ++part) {
    if (!table.is_own(pool.owner[part])) continue;
    const std::size_t q = pool.owner[part] - table.own_first();
    on_queue(q, "loading the parts of the scene",
             [&] { pool.workers[q]->warm_up(pool.stores[q]->get(part), *pool.outboxes[q].front()); });
  }
}

}  // namespace kdray::odprt
