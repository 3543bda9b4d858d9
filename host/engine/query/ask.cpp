#include "engine/query/ask.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "engine/query/grains.h"
#include "engine/query/write_hits.h"

namespace kdray::query {

void check_invalid(const LocalRays& rays, const QueryOptions& options) {
  if (options.invalid == InvalidRays::error && rays.first_invalid())
    throw Error(ErrorCode::input, *rays.first_invalid());
}

void check_out(std::size_t size, std::size_t n, const char* name) {
  if (size != 0 && size != n)
    throw Error(ErrorCode::input, fmt::format("{}: there are {} places for {} answers", name, size, n));
}

namespace {

// A chunk that is being traced.
struct Chunk {
  explicit Chunk(const QueryContext& context, const RayArrays& rays)
      : session(context.sessions.rays.borrow()), local(rays, context.frame) {}

  Sessions<Session>::Borrowed session;
  LocalRays local;
  std::size_t first = 0, n = 0;  // 0: none
};

// Rays of a chunk: so many that the device has chunks to work at while the host works at others.
std::size_t chunk_for(std::size_t n, std::size_t most) {
  constexpr std::size_t kLeast = std::size_t{1} << 14, kChunks = 8;
  return std::min(most, std::max(kLeast, n / kChunks));
}

// Calls take(chunk, hits, begin, end) for grains of the hits of each chunk, in turn. While two chunks are
// traced the next one's rays are made ready.
template <class Take>
class ChunkTracer {
 public:
  ChunkTracer(const QueryContext& context, const RayArrays& rays, bool any_hit, bool as_refs,
              const Take& take)
      : context_(context), rays_(rays), any_hit_(any_hit), as_refs_(as_refs), take_(take) {}

  QueryReport run(const QueryOptions& options) {
    if (rays_.size() == 0) return {};
    chunks_[0].emplace(context_, rays_);
    const std::size_t at_once = chunk_for(rays_.size(), chunks_[0]->session->chunk());
    for (std::size_t first = 0, turn = 0; first < rays_.size(); first += at_once, turn ^= 1) {
      throw_if_cancelled(options.cancel);
      if (!chunks_[turn]) chunks_[turn].emplace(context_, rays_);
      finish(*chunks_[turn]);
      start(*chunks_[turn], first, std::min(at_once, rays_.size() - first), options);
      last_ = turn;
    }
    QueryReport report;
    for (const std::size_t turn : {last_ ^ 1, last_}) {
      if (!chunks_[turn]) continue;
      finish(*chunks_[turn]);
      report.invalid += chunks_[turn]->local.n_invalid();
    }
    return report;
  }

 private:
  void start(Chunk& chunk, std::size_t first, std::size_t n, const QueryOptions& options) {
    chunk.local.fill(first, n, chunk.session->rays());
    check_invalid(chunk.local, options);
    if (context_.target.masks() != nullptr)
      for (std::size_t i = 0; i < n; ++i) chunk.session->ray_masks()[i] = rays_.mask(first + i);
    chunk.session->start(n, any_hit_, as_refs_);
    chunk.first = first;
    chunk.n = n;
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
  const RayArrays& rays_;
  bool any_hit_, as_refs_;
  const Take& take_;
  std::optional<Chunk> chunks_[2];
  std::size_t last_ = 0;
};

template <class Take>
QueryReport trace_chunks(const QueryContext& context, const RayArrays& rays, bool any_hit, bool as_refs,
                         const QueryOptions& options, const Take& take) {
  return ChunkTracer<Take>(context, rays, any_hit, as_refs, take).run(options);
}

}  // namespace

QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options) {
  const RayArrays arrays(rays);
  const HitWriter writer(context, arrays, out);
  return trace_chunks(
      context, arrays, false, writer.wants_refs(), options,
      [&](const Chunk& chunk, std::span<const layout::QueryHit> hits, std::size_t begin, std::size_t end) {
        writer.write(chunk.first, begin, end, {hits, chunk.session->instances()}, chunk.local);
      });
}

QueryReport any(const QueryContext& context, const Rays& rays, const BytesOut& out,
                const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "hit");
  return trace_chunks(
      context, arrays, true, false, options,
      [&](const Chunk& chunk, std::span<const layout::QueryHit> hits, std::size_t begin, std::size_t end) {
        if (out.empty()) return;
        out.fill(chunk.first + begin, end - begin, [&](std::size_t ray) {
          return std::array{static_cast<std::uint8_t>(hits[ray - chunk.first].t == 0)};
        });
      });
}

}  // namespace kdray::query
