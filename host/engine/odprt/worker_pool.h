// What    The workers of a frame, with what each has: parts, outboxes, a report.
#pragma once

#include <memory>
#include <vector>

#include "engine/odprt/exchange.h"
#include "engine/odprt/part_store.h"
#include "engine/odprt/provision.h"
#include "engine/odprt/worker.h"

namespace kdray::odprt {

struct WorkerPool {
  BufferPlan plan;
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<std::unique_ptr<PartStore>> stores;
  std::vector<std::vector<std::unique_ptr<Outbox>>> outboxes;  // by worker
  std::vector<std::size_t> owner;         // the queue of each part, among those of all ranks
  std::vector<std::vector<bool>> direct;  // [worker][part]: reads the worker's outbox itself
  std::vector<QueueReport> reports;       // by worker; grow from band to band
};

// Parts go to the queues in turn.
WorkerPool make_worker_pool(const Request& request, const Provision& provision, const Division& division,
                            const Cut& cut);

// Loads what stays on the devices, before the frame's time is taken.
void load_parts(WorkerPool& pool, const RankTable& table, const Provision& provision);

}  // namespace kdray::odprt
