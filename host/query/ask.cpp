#include "query/ask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "query/grains.h"
#include "query/surface.h"

namespace kdray::query {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void throw_if_cancelled(const QueryOptions& options) {
  if (options.cancel && options.cancel->is_cancelled())
    throw Error(ErrorCode::cancelled, "the query was cancelled");
}

void check_invalid(const LocalRays& rays, const QueryOptions& options) {
  if (options.invalid == InvalidRays::error && rays.first_invalid())
    throw Error(ErrorCode::input, *rays.first_invalid());
}

void check_out(std::size_t size, std::size_t n, const char* name) {
  if (size != 0 && size != n)
    throw Error(ErrorCode::input, fmt::format("{}: there are {} places for {} rays", name, size, n));
}

// Calls take(first, hits, local rays) for each chunk of hits, in turn.
template <class Take>
QueryReport trace_chunks(const Asked& asked, const RayArrays& rays, bool any_hit, bool as_refs,
                         const QueryOptions& options, const Take& take) {
  const bool masked = asked.sessions.has_masks() || !rays.rays().masks.empty();
  const Sessions::Borrowed session = asked.sessions.borrow({.masked = masked});
  LocalRays local(rays, asked.frame);
  for (std::size_t first = 0; first < rays.size(); first += session->chunk()) {
    throw_if_cancelled(options);
    const std::size_t n = std::min(session->chunk(), rays.size() - first);
    local.fill(first, n, session->rays());
    check_invalid(local, options);
    if (masked)
      for (std::size_t i = 0; i < n; ++i) session->ray_masks()[i] = rays.mask(first + i);
    take(first, session->trace(n, any_hit, as_refs), local);
  }
  return {local.n_invalid()};
}

// Writes answers where the caller wants them.
class HitWriter {
 public:
  HitWriter(const Asked& asked, const RayArrays& rays, const HitsOut& out)
      : asked_(&asked), rays_(&rays), out_(out) {
    const std::size_t n = rays.size();
    check_out(out.t.size(), n, "t");
    check_out(out.geometry.size(), n, "geometry");
    check_out(out.primitive.size(), n, "primitive");
    check_out(out.u.size(), n, "u");
    check_out(out.v.size(), n, "v");
    check_out(out.normal.size(), n, "normal");
    check_out(out.point.size(), n, "point");
  }

  bool wants_refs() const { return !out_.normal.empty(); }

  void write(std::size_t ray, const layout::QueryHit& hit, double t) const {
    const bool missed = hit.primitive == -1;
    GeometryTable::Place place{kNoGeometry, kNoPrimitive};
    if (!missed) place = asked_->table.of(number_of(hit));
    if (!out_.t.empty()) out_.t.set(ray, {missed ? kInfinity : t});
    if (!out_.geometry.empty()) out_.geometry.set(ray, {place.geometry});
    if (!out_.primitive.empty()) out_.primitive.set(ray, {place.primitive});
    if (!out_.u.empty()) out_.u.set(ray, {hit.u});
    if (!out_.v.empty()) out_.v.set(ray, {hit.v});
    if (!out_.normal.empty() || !out_.point.empty()) write_surface(ray, hit, t, missed);
  }

 private:
  std::uint32_t number_of(const layout::QueryHit& hit) const {
    const auto word = static_cast<std::uint32_t>(hit.primitive);
    return wants_refs() ? query::number_of(asked_->scene.flat, word) : word;
  }

  void write_surface(std::size_t ray, const layout::QueryHit& hit, double t, bool missed) const {
    const dvec3 world = missed ? dvec3(kInfinity) : rays_->origin(ray) + t * rays_->direction(ray);
    if (!out_.point.empty()) out_.point.set(ray, {world.x, world.y, world.z});
    if (out_.normal.empty()) return;
    dvec3 normal(0);
    if (!missed)
      normal = normal_at(asked_->scene.flat, static_cast<std::uint32_t>(hit.primitive),
                         asked_->frame.space().local(world));
    out_.normal.set(ray, {normal.x, normal.y, normal.z});
  }

  const Asked* asked_;
  const RayArrays* rays_;
  HitsOut out_;
};

}  // namespace

QueryReport closest(const Asked& asked, const Rays& rays, const HitsOut& out, const QueryOptions& options) {
  const RayArrays arrays(rays);
  const HitWriter writer(asked, arrays, out);
  return trace_chunks(asked, arrays, false, writer.wants_refs(), options,
                      [&](std::size_t first, std::span<const layout::QueryHit> hits, const LocalRays& local) {
                        for_each_grain(hits.size(), [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i)
                            writer.write(first + i, hits[i], local.world_t(i, hits[i].t));
                        });
                      });
}

QueryReport any(const Asked& asked, const Rays& rays, const BytesOut& out, const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "hit");
  return trace_chunks(asked, arrays, true, false, options,
                      [&](std::size_t first, std::span<const layout::QueryHit> hits, const LocalRays&) {
                        for_each_grain(hits.size(), [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i)
                            if (!out.empty()) out.set(first + i, {static_cast<std::uint8_t>(hits[i].t == 0)});
                        });
                      });
}

}  // namespace kdray::query
