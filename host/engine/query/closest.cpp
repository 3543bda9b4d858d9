#include "engine/query/queries.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.h"
#include "engine/query/double_rays.h"
#include "engine/query/grains.h"
#include "engine/query/shared_rows.h"
#include "engine/query/surface.h"
#include "engine/query/write_hits.h"

namespace kdray::query {

void check_invalid(const LocalRays& rays, InvalidRays invalid) {
  if (invalid == InvalidRays::error && rays.first_invalid())
    throw Error(ErrorCode::input, *rays.first_invalid());
}

void check_out(std::size_t size, std::size_t n, const char* name) {
  if (size != 0 && size != n)
    throw Error(ErrorCode::input, fmt::format("{}: there are {} places for {} answers", name, size, n));
}

namespace {

// A chunk that is being traced.
struct Chunk {
  Chunk(const QueryContext& context, Place& place, const RayArrays& rays)
      : session(place.sessions.rays.borrow()), local(rays, context.frame) {}

  Sessions<Session>::Borrowed session;
  LocalRays local;
  std::size_t first = 0, n = 0;  // 0: none
};

// Calls of fewer rays go to one place alone.
constexpr std::size_t kFewRays = std::size_t{1} << 14;

// Rays of a chunk of the n that a place has: so many that the device has chunks to work at while the host
// works at others.
std::size_t chunk_for(std::size_t n, std::size_t most) {
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

// ---- Of a scene of doubles.

template <class Column, class ValueOf>
void fill(const Column& column, std::size_t first, std::size_t n, const ValueOf& value_of) {
  if (column.empty()) return;
  column.fill(first, n, [&](std::size_t ray) { return value_of(ray); });
}

QueryReport closest_of_doubles(const QueryContext& context, const RayArrays& arrays, const HitsOut& out,
                               const QueryOptions& options) {
  const DoubleRays rays(context, arrays);
  const prepare::Prepared& scene = context.scene();
  return rays.run(options, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    std::vector<std::optional<ExactHit>> hits(n);
    rays.scene().closest(rays.questions(first, n), hits);
    const auto put = [&](const auto& column, const auto& of_miss, const auto& of_hit) {
      fill(column, first, n, [&](std::size_t ray) {
        const std::optional<ExactHit>& hit = hits[ray - first];
        return hit ? of_hit(ray, *hit) : of_miss;
      });
    };
    const auto place_of = [&](const ExactHit& hit) {
      return context.table.of(number_of(scene.flat, hit.ref));
    };
    const auto array_of = [](const dvec3& v) { return std::array{v.x, v.y, v.z}; };
    put(out.t, std::array{HUGE_VAL}, [](std::size_t, const ExactHit& hit) { return std::array{hit.t}; });
    put(out.geometry, std::array{kNoGeometry},
        [&](std::size_t, const ExactHit& hit) { return std::array{place_of(hit).geometry}; });
    put(out.primitive, std::array{kNoPrimitive},
        [&](std::size_t, const ExactHit& hit) { return std::array{place_of(hit).primitive}; });
    put(out.u, std::array{0.0}, [](std::size_t, const ExactHit& hit) { return std::array{hit.u}; });
    put(out.v, std::array{0.0}, [](std::size_t, const ExactHit& hit) { return std::array{hit.v}; });
    put(out.normal, array_of(dvec3(0)), [&](std::size_t, const ExactHit& hit) {
      return array_of(normal_of(scene.doubles->at(hit.ref & KDRAY_REF_INDEX_MASK)));
    });
    put(out.point, array_of(dvec3(HUGE_VAL)), [&](std::size_t ray, const ExactHit& hit) {
      return array_of(arrays.origin(ray) + hit.t * arrays.direction(ray));
    });
    put(out.instance, std::array{kNoInstance},
        [](std::size_t, const ExactHit&) { return std::array{kNoInstance}; });
  });
}

}  // namespace

QueryReport closest(const QueryContext& context, const Rays& rays, const HitsOut& out,
                    const QueryOptions& options) {
  const RayArrays arrays(rays);
  const HitWriter writer(context, arrays, out);
  if (context.scene().doubles) return closest_of_doubles(context, arrays, out, options);
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
  if (context.scene().doubles) {
    const DoubleRays in_doubles(context, arrays);
    return in_doubles.run(options, [&](std::size_t first, std::size_t last) {
      std::vector<std::uint8_t> hit(last - first);
      in_doubles.scene().any(in_doubles.questions(first, last - first), hit);
      fill(out, first, last - first, [&](std::size_t i) { return std::array{hit[i - first]}; });
    });
  }
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
