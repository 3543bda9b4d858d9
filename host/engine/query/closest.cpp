#include "engine/query/queries.h"

#include <fmt/format.h>

#include "base/error.h"
#include "engine/query/chunk_tracer.h"
#include "engine/query/closest_doubles.h"
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
  if (context.scene().doubles) return any_of_doubles(context, arrays, out, options);
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
