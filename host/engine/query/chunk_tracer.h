// What    Rays of a call put to the device, chunk by chunk: closest or any hits.
#pragma once

#include <algorithm>
#include <atomic>
#include <optional>
#include <span>

#include "engine/query/grains.h"
#include "engine/query/queries.h"
#include "engine/query/shared_rows.h"

namespace kdray::query {

// A chunk that is being traced.
struct Chunk {
  Chunk(const QueryContext& context, Place& place, const RayArrays& rays)
      : session(place.sessions.rays.borrow()),
        local(rays, context.frame, context.scene().doubles != nullptr) {}

  Sessions<Session>::Borrowed session;
  LocalRays local;
  std::size_t first = 0, n = 0;  // 0: none
};

// Calls of fewer rays go to one place alone.
inline constexpr std::size_t kFewRays = std::size_t{1} << 14;

// Rays of a chunk of the n that a place has: so many that the device has chunks to work at while the host
// works at others.
inline std::size_t chunk_for(std::size_t n, std::size_t most) {
  constexpr std::size_t kChunks = 8;
  return std::min(most, std::max(kFewRays, n / kChunks));
}

// Calls take(chunk, hits, begin, end) for grains of the hits of each chunk of a place, in turn. While two
// chunks are traced the next one's rays are made ready.
template <class Take>
class ChunkTracer {
 public:
  ChunkTracer(const QueryContext& context, Place& place, const RayArrays& rays, bool any_hit, bool as_refs,
              const Take& take)
      : context_(context), place_(place), rays_(rays), any_hit_(any_hit), as_refs_(as_refs), take_(take) {}

  QueryReport run(RowTaker& rows, InvalidRays invalid, const std::optional<Cancel>& cancel) {
    chunks_[0].emplace(context_, place_, rays_);
    const std::size_t at_once = chunk_for(rows.fair_share(), chunks_[0]->session->chunk());
    std::size_t turn = 0;
    for (RowRange taken = rows.take(at_once); taken.n > 0; taken = rows.take(at_once), turn ^= 1) {
      throw_if_cancelled(cancel);
      if (!chunks_[turn]) chunks_[turn].emplace(context_, place_, rays_);
      finish(*chunks_[turn]);
      start(*chunks_[turn], taken, invalid);
    }
    QueryReport report;
    for (const std::size_t t : {turn, turn ^ 1}) {
      if (!chunks_[t]) continue;
      finish(*chunks_[t]);
      report.invalid += chunks_[t]->local.n_invalid();
    }
    return report;
  }

 private:
  void start(Chunk& chunk, const RowRange& taken, InvalidRays invalid) {
    chunk.local.fill(taken.first, taken.n, chunk.session->rays());
    check_invalid(chunk.local, invalid);
    if (context_.has_masks())
      for (std::size_t i = 0; i < taken.n; ++i) chunk.session->ray_masks()[i] = rays_.mask(taken.first + i);
    chunk.session->start(taken.n, any_hit_, as_refs_);
    chunk.first = taken.first;
    chunk.n = taken.n;
  }

  void finish(Chunk& chunk) {
    if (chunk.n == 0) return;
    const std::span<const layout::QueryHit> hits = chunk.session->wait();
    std::atomic<bool> failed{false};
    for_each_grain(hits.size(), [&](std::size_t begin, std::size_t end) {
      bool all_sound = true;
      for (std::size_t i = begin; i < end; ++i) all_sound &= hits[i].primitive != kFailedWalk;
      if (!all_sound) failed.store(true, std::memory_order_relaxed);
      take_(chunk, hits, begin, end);
    });
    chunk.n = 0;
    if (failed) throw_failed_walk();
  }

  const QueryContext& context_;
  Place& place_;
  const RayArrays& rays_;
  bool any_hit_, as_refs_;
  const Take& take_;
  std::optional<Chunk> chunks_[2];
};

// The same by all places.
template <class Take>
QueryReport trace_chunks(const QueryContext& context, const RayArrays& rays, bool any_hit, bool as_refs,
                         const QueryOptions& options, const Take& take) {
  if (rays.size() == 0) return {};
  return share_rows(context, rays.size(), kFewRays, options.cancel,
                    [&](Place& place, RowTaker& rows, const std::optional<Cancel>& cancel) {
                      return ChunkTracer<Take>(context, place, rays, any_hit, as_refs, take)
                          .run(rows, options.invalid, cancel);
                    });
}

}  // namespace kdray::query
