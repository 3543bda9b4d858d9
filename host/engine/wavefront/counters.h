// What    What a frame's slices count: rays of each kind, rays that were found needless, faults.
// Shape   One list for all of it: a counter's name here, the field of layout::Slice that it adds up, and its
//         key in the statistics. Sums, and the keys of `--stats` (host/api/statistics_json.h), follow from
//         the list.
// Errors  check(): ErrorCode::internal where a fault was counted, since the picture would be wrong.
#pragma once

#include <cstdint>
#include <span>

#include "layout/frame.layout.h"

// X(counter, field of layout::Slice, key in the statistics)
#define KDRAY_COUNTERS_OF_TRACED(X)            \
  X(primary, n_primary, "primary")             \
  X(primary_hit, n_primary_hit, "primary_hit") \
  X(shadow, n_shadow_rays, "shadow")           \
  X(reflected, n_reflected, "reflected")       \
  X(refracted, n_refracted, "refracted")
#define KDRAY_COUNTERS_OF_SKIPPED(X)                               \
  X(skipped_behind, n_skipped_behind, "light_behind")              \
  X(skipped_unlit, n_skipped_unlit, "light_of_no_weight")          \
  X(skipped_open, n_skipped_open, "light_in_the_open")             \
  X(skipped_background, n_skipped_background, "of_the_background") \
  X(skipped_weight, n_skipped_weight, "below_min_weight")          \
  X(skipped_depth, n_skipped_depth, "too_deep")                    \
  X(skipped_glass, n_skipped_glass, "too_deep_in_glass")
// What a correct render never counts.
#define KDRAY_COUNTERS_OF_FAULTS(X) \
  X(invalid, n_invalid, "invalid")  \
  X(nan, n_nan, "nan")              \
  X(pool_overflow, n_pool_overflow, "pool_overflow")
#define KDRAY_COUNTERS(X)      \
  KDRAY_COUNTERS_OF_TRACED(X)  \
  KDRAY_COUNTERS_OF_SKIPPED(X) \
  KDRAY_COUNTERS_OF_FAULTS(X)  \
  X(waves, n_waves, "waves")   \
  X(of_empty_blocks, n_of_empty_blocks, "samples_of_empty_blocks")

namespace kdray::wavefront {

struct Counters {
#define KDRAY_COUNTER(name, field, key) std::uint64_t name = 0;
  KDRAY_COUNTERS(KDRAY_COUNTER)  // waves: of one slice, with rays in them; of empty blocks: of primary
#undef KDRAY_COUNTER
  std::uint64_t launches = 0;  // counted by the host

  std::uint64_t total() const {
    return primary + shadow + reflected + refracted;
  }
  void add(const layout::Slice& slice);
  void add(const Counters& other);
};

// Of all slices, as the last launch left them.
Counters sum_of(std::span<const layout::Slice> slices);

// Throws where a fault was counted. `lost`: rays that another queue was to find the hit of again (ODPRT).
void check(const Counters& counters, std::uint64_t lost = 0);

}  // namespace kdray::wavefront
