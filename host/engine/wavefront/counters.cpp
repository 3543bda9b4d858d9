#include "engine/wavefront/counters.h"

#include <fmt/format.h>

#include "base/error.h"

namespace kdray::wavefront {

void Counters::add(const layout::Slice& slice) {
#define KDRAY_ADD(name, field, key) name += slice.field;
  KDRAY_COUNTERS(KDRAY_ADD)
#undef KDRAY_ADD
}

void Counters::add(const Counters& other) {
#define KDRAY_ADD(name, field, key) name += other.name;
  KDRAY_COUNTERS(KDRAY_ADD)
#undef KDRAY_ADD
  launches += other.launches;
}

Counters sum_of(std::span<const layout::Slice> slices) {
  Counters sum;
  for (const layout::Slice& slice : slices) sum.add(slice);
  return sum;
}

void check(const Counters& sum, std::uint64_t lost) {
  if (sum.invalid + sum.nan + sum.pool_overflow + lost == 0) return;
  throw Error(
      ErrorCode::internal,
      fmt::format("{} rays overflowed the traversal's stack, {} the ray pool, {} lost their hit, and {} "
                  "contributions were not numbers; this is a fault of kdray, please report it with the "
                  "scene",
                  sum.invalid, sum.pool_overflow, lost, sum.nan));
}

}  // namespace kdray::wavefront
