#include "query/ask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "query/grains.h"
#include "query/surface.h"

namespace kdray::query {

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
    throw Error(ErrorCode::input, fmt::format("{}: there are {} places for {} answers", name, size, n));
}

namespace {

// Calls take(first, hits, local rays) for each chunk of hits, in turn.
template <class Take>
QueryReport trace_chunks(const Asked& asked, const RayArrays& rays, bool any_hit, bool as_refs,
                         const QueryOptions& options, const Take& take) {
  const bool masked = asked.target.masks() != nullptr;
  const Sessions::Borrowed session = asked.sessions.borrow();
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

  // Column by column: of rays first + begin to first + end, of which hits[begin] is the first's.
  void write(std::size_t first, std::size_t begin, std::size_t end, std::span<const layout::QueryHit> hits,
             const LocalRays& local) const {
    const auto fill = [&](const auto& column, const auto& value_of) {
      if (column.empty()) return;
      column.fill(first + begin, end - begin,
                  [&](std::size_t ray) { return value_of(ray, hits[ray - first]); });
    };
    const auto t_of = [&](std::size_t ray, const layout::QueryHit& hit) {
      return missed(hit) ? HUGE_VAL : local.world_t(ray - first, hit.t);
    };
    fill(out_.t, [&](std::size_t ray, const auto& hit) { return std::array{t_of(ray, hit)}; });
    fill(out_.geometry, [&](std::size_t, const auto& hit) { return std::array{place_of(hit).geometry}; });
    fill(out_.primitive, [&](std::size_t, const auto& hit) { return std::array{place_of(hit).primitive}; });
    fill(out_.u, [](std::size_t, const auto& hit) { return std::array{hit.u}; });
    fill(out_.v, [](std::size_t, const auto& hit) { return std::array{hit.v}; });
    fill(out_.normal, [&](std::size_t ray, const auto& hit) { return normal_of(ray, hit, t_of(ray, hit)); });
    fill(out_.point, [&](std::size_t ray, const auto& hit) { return array(point_of(ray, t_of(ray, hit))); });
  }

 private:
  static bool missed(const layout::QueryHit& hit) { return hit.primitive == -1; }
  static std::array<double, 3> array(const dvec3& v) { return {v.x, v.y, v.z}; }

  GeometryTable::Place place_of(const layout::QueryHit& hit) const {
    if (missed(hit)) return {kNoGeometry, kNoPrimitive};
    const auto word = static_cast<std::uint32_t>(hit.primitive);
    return asked_->table.of(wants_refs() ? number_of(asked_->scene().flat, word) : word);
  }

  dvec3 point_of(std::size_t ray, double t) const {
    return std::isinf(t) ? dvec3(HUGE_VAL) : rays_->origin(ray) + t * rays_->direction(ray);
  }

  std::array<double, 3> normal_of(std::size_t ray, const layout::QueryHit& hit, double t) const {
    if (missed(hit)) return {0, 0, 0};
    return array(normal_at(asked_->scene().flat, static_cast<std::uint32_t>(hit.primitive),
                           asked_->frame.space().local(point_of(ray, t))));
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
                          writer.write(first, begin, end, hits, local);
                        });
                      });
}

QueryReport any(const Asked& asked, const Rays& rays, const BytesOut& out, const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "hit");
  return trace_chunks(asked, arrays, true, false, options,
                      [&](std::size_t first, std::span<const layout::QueryHit> hits, const LocalRays&) {
                        if (out.empty()) return;
                        for_each_grain(hits.size(), [&](std::size_t begin, std::size_t end) {
                          out.fill(first + begin, end - begin, [&](std::size_t ray) {
                            return std::array{static_cast<std::uint8_t>(hits[ray - first].t == 0)};
                          });
                        });
                      });
}

}  // namespace kdray::query
