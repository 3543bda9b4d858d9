#include "engine/odprt/worker_pool.h"

#include <algorithm>
#include <numeric>

#include "engine/odprt/executor.h"
#include "layout/compressed.layout.h"

namespace kdray::odprt {

namespace {

using wavefront::SceneBuffers;

// For each array the size that it has in the part that has most of it.
SceneBuffers::Sizes largest_sizes(const Division& division) {
  SceneBuffers::Sizes most{};
  for (const Part& part : division.parts) {
    const SceneBuffers::Sizes sizes = SceneBuffers::sizes_of(part.flat, part.wide);
    for (std::size_t i = 0; i < sizes.size(); ++i) most[i] = std::max(most[i], sizes[i]);
  }
  return most;
}

}  // namespace

std::size_t buffer_bytes(const Division& division, bool compressed) {
  SceneBuffers::Sizes sizes = largest_sizes(division);
  for (const std::size_t no_geometry : {SceneBuffers::Slot::materials, SceneBuffers::Slot::lights})
    sizes[no_geometry] = 0;
  const std::size_t n_nodes = sizes[SceneBuffers::Slot::wide_nodes] / sizeof(layout::WideNode);
  return std::accumulate(sizes.begin(), sizes.end(),
                         compressed ? n_nodes * sizeof(layout::CompressedNode) : std::size_t{0});
}

SceneBuffers PartStore::scene_of(const Part& part) {
  if (!streamed_) return {context_, part.flat, part.wide};
  if (!buffers_) buffers_.emplace(context_, largest_sizes(division_));
  buffers_->copy(queue_, part.flat, part.wide);
  return *buffers_;
}

const LoadedPart& PartStore::get(std::uint32_t number) {
  if (loaded_ && loaded_->number == number) return *loaded_;
  const Part& part = division_.parts[number];
  std::vector<layout::PartCell> cells;
  for (const std::uint32_t i : division_.subtrees_of(number)) {
    const Box& box = cut_.subtrees[i].bounds;
    cells.push_back({{box.lo.x, box.lo.y, box.lo.z}, number, {box.hi.x, box.hi.y, box.hi.z}, 0});
  }
  loaded_.emplace(
      LoadedPart{number, part.n_shared, division_.replicates(), scene_of(part),
                 context_.buffer(CL_MEM_READ_ONLY, cells.size() * sizeof cells[0], "the subtrees"),
                 static_cast<std::uint32_t>(cells.size())});
  if (!cells.empty())
    queue_.enqueueWriteBuffer(loaded_->subtrees, CL_TRUE, 0, cells.size() * sizeof cells[0], cells.data());
  ++n_loads_;
  return *loaded_;
}

std::size_t PartStore::bytes() const {
  if (buffers_) return buffer_bytes(division_, compressed_);
  if (!loaded_) return 0;
  const Part& part = division_.parts[loaded_->number];
  return part.geometry_bytes() + (compressed_ ? part.wide.nodes.size() * sizeof(layout::CompressedNode) : 0);
}

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
