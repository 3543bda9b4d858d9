// What    Decides exactly what floats leave open of a caller's rays of doubles in a scene of floats: the hits
//         of rays that begin or end too near to a surface, and t in double of the others.
// Shape   Rays of floats don't come here, and a scene of doubles has double_scene.h. t is in the units of the
//         caller's rays.
// Threads As many calls at once as there are threads.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/all_hits.h"
#include "engine/query/exact_scene.h"
#include "engine/query/queries.h"
#include "engine/query/shared_rows.h"

namespace kdray::query {

// Of each ray of a chunk.
class ExactHits {
 public:
  ExactHits() = default;
  explicit ExactHits(std::size_t n_rays)
      : more(n_rays), ends_(n_rays), grains_((n_rays + kSlowGrain - 1) / kSlowGrain) {}

  std::vector<std::uint8_t> more;  // 1: it has more than max_hits

  // Rays of a grain of for_each_slow_grain() get theirs one after the other, by one thread.
  void put(std::size_t ray, std::span<const ExactHit> hits) {
    std::vector<ExactHit>& grain = grains_[ray / kSlowGrain];
    grain.insert(grain.end(), hits.begin(), hits.end());
    ends_[ray] = static_cast<std::uint32_t>(grain.size());
  }
  std::span<const ExactHit> of(std::size_t ray) const {
    const std::uint32_t first = ray % kSlowGrain == 0 ? 0 : ends_[ray - 1];
    return std::span(grains_[ray / kSlowGrain]).subspan(first, ends_[ray] - first);
  }

 private:
  std::vector<std::uint32_t> ends_;  // where each ray's end in its grain
  std::vector<std::vector<ExactHit>> grains_;
};

class ExactRays {
 public:
  ExactRays(const QueryContext& context, const RayArrays& rays)
      : context_(&context), rays_(&rays), scene_(context.scene()) {}

  // Counts anew, of rays first and on, what those cross that begin or end near a surface.
  void count(std::size_t first, std::span<std::uint32_t> counts, const std::optional<Cancel>& cancel) const;

  // All hits of rays first and on, from those that floats have found, which are named by reference.
  ExactHits settle(std::size_t first, const LocalHits& found, std::uint32_t max_hits,
                   const std::optional<Cancel>& cancel) const;

  // The closest hit of ray i from the one that floats have found, if any, with t in double; and found anew,
  // by a walk on the host, where that t is not between the ray's t_min and t_max or so near to t_min that
  // floats can't tell what lies ahead, and where nothing is nearer than what lies as near to t_max.
  std::optional<ExactHit> closest(std::size_t i, const std::optional<ExactHit>& found) const;

 private:
  // None for rays that mean nothing or meet nothing.
  std::optional<LocalLine> line_of(std::size_t i) const;
  // Whether the line is too near to a surface there.
  bool is_near(const LocalLine& line, double t) const;
  bool has_end_near(std::size_t i, const LocalLine& line) const;
  bool ends_outside(std::size_t i) const;  // of the scene's bounds, surely
  // What the ray crosses at t_min or above and below t_max, in no order; of what lies beyond `most` some may
  // be left out.
  void cross(std::size_t i, const LocalLine& line, double most, std::vector<ExactHit>& hits) const;
  void all_hits(std::size_t i, const LocalLine& line, std::vector<ExactHit>& hits) const;
  double distance(std::size_t i, const LocalLine& line, const ExactHit& about) const;
  // `most`: where the ray seems to hit something, or t_max.
  std::optional<ExactHit> closest_anew(std::size_t i, const LocalLine& line, double most) const;
  bool is_seen(const ExactHit& hit, std::uint32_t mask) const;

  const QueryContext* context_;
  const RayArrays* rays_;
  ExactScene scene_;
};

}  // namespace kdray::query
