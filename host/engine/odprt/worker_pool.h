// What    The workers of a frame, with what each has: parts, outboxes, a report.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/odprt/division.h"
#include "engine/odprt/exchange.h"
#include "engine/odprt/provision.h"
#include "engine/odprt/worker.h"

namespace kdray::odprt {

// The bytes of buffers that any part's geometry fits into: each array as large as the part with most of it
// needs. Where parts hold different kinds of primitives, that is more than the largest part. `compressed`:
// the nodes' compressed form is wanted as well.
std::size_t buffer_bytes(const Division& division, bool compressed);

// The part that a queue's device holds: its only one, or, where memory is short, one at a time in buffers
// that are made once.
class PartStore {
 public:
  // With `streamed` parts come and go; else they are used where they lie, if the device works in the host's
  // memory.
  PartStore(const device::Context& context, cl::CommandQueue queue, const Division& division, const Cut& cut,
            bool streamed, bool compressed)
      : context_(context),
        queue_(std::move(queue)),
        division_(division),
        cut_(cut),
        streamed_(streamed),
        compressed_(compressed) {}

  // Loads the part if it isn't there; nothing may be running that reads the last one. What it returns stays
  // until another is asked for.
  const LoadedPart& get(std::uint32_t part);

  std::size_t bytes() const;  // of geometry; of streamed parts that of the buffers
  std::uint64_t n_loads() const { return n_loads_; }

 private:
  wavefront::SceneBuffers scene_of(const Part& part);

  const device::Context& context_;
  cl::CommandQueue queue_;
  const Division& division_;
  const Cut& cut_;
  const bool streamed_, compressed_;
  std::optional<wavefront::SceneBuffers> buffers_;  // streamed: large enough for every part
  std::optional<LoadedPart> loaded_;
  std::uint64_t n_loads_ = 0;
};

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
