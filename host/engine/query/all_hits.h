// What    All hits of rays from outside, or how many there are. Every crossing of a surface counts once, at
//         edges and vertices too (kernels/intersect/crossing.clh): a ray from outside of a closed mesh to
//         outside has an even number.
// Shape   The hits of ray i are [splits[i], splits[i + 1]), sorted by t and, where that is equal, by instance
//         (what is in none first) and primitive. A hit counts where t_min < t < t_max; one in the start
//         point, at t = 0, where t_min is 0. A ray has any number of hits: what goes beyond a list on the
//         device is found in further passes, in bounded memory but for the answer's own.
// Errors  ErrorCode::input for a ray that is not one (check_rays.h), unless such are to miss;
//         ErrorCode::usage for the binary walk, which doesn't find all hits; ErrorCode::cancelled.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/memory.h"
#include "engine/query/target.h"
#include "kdray/cancel.h"
#include "kdray/options.h"
#include "kdray/ray.h"

namespace kdray::query {

struct CollectOptions {
  std::uint32_t max_hits = std::numeric_limits<std::uint32_t>::max();  // of a ray: the first so many
  Traversal traversal = Traversal::automatic;  // wide or batch, or as the target has it
  bool faulty_miss = false;                    // rays that are none meet nothing
  std::span<const std::uint32_t> masks =
      {};                             // of each ray; none: all bits; counts where primitives have masks
  bool as_refs = false;               // hits by reference and instances by index
  std::optional<Cancel> cancel = {};  // looked at before each launch
  // Of all rays together; where there are more, all_hits() gives up.
  std::size_t at_once = std::numeric_limits<std::size_t>::max();
};

struct LocalHits {
  RawVector<std::uint64_t> splits;  // one more than rays
  RawVector<float> t;
  RawVector<std::uint32_t> primitive;  // number in file order, or reference
  RawVector<float> u, v;               // as Hit's
  RawVector<std::uint8_t> more;        // of each ray, 1: it has more than max_hits
  // The place in the scene's list of the instance that each hit lies in, or kNoInstance; empty where the
  // scene has none.
  RawVector<std::uint32_t> instance;
  RawVector<std::uint8_t> in_doubt;  // of each ray of a scene of doubles: 1: its hits mean nothing
};

// A count of a scene of doubles that is in doubt.
inline constexpr std::uint32_t kInDoubtCount = std::numeric_limits<std::uint32_t>::max();

// Kernels and buffers for it (passes.h).
class Passes;
// In place of what `all` held, whose memory serves again. The passes' traversal counts. False: there are more
// hits than options.at_once.
bool all_hits(Passes& passes, std::span<const Ray> rays, const CollectOptions& options, LocalHits& all);
LocalHits all_hits(const Target& target, std::span<const Ray> rays, const CollectOptions& options = {});

void all_hits(const Target& target, std::span<const Ray> rays, const CollectOptions& options, LocalHits& all);

// Of each ray; max_hits where there are more.
void count_hits(Passes& passes, std::span<const Ray> rays, const CollectOptions& options,
                std::span<std::uint32_t> counts);
std::vector<std::uint32_t> count_hits(const Target& target, std::span<const Ray> rays,
                                      const CollectOptions& options = {});

}  // namespace kdray::query
