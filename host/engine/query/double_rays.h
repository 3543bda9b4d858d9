// What    Rays of a program against a scene of doubles: what the host answers by itself, of few rays and of
//         those that the filter leaves in doubt (double_scene.h), and what it finds in double of hits that
//         the filter is sure of.
// Errors  As kdray/query.h says of rays that are none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "engine/query/double_scene.h"
#include "engine/query/exact_rays.h"
#include "engine/query/queries.h"
#include "engine/query/shared_rows.h"

namespace kdray::query {

class DoubleRays {
 public:
  DoubleRays(const QueryContext& context, const RayArrays& rays);

  const DoubleScene& scene() const { return scene_; }

  // None of a ray that meets nothing.
  std::optional<DoubleScene::Question> question(std::size_t i, std::size_t place) const;
  // Of these rays; places count from the first.
  std::vector<DoubleScene::Question> questions(std::size_t first, std::size_t n) const;
  // With components that a question drops for being tiny: t and weights don't feel them.
  DoubleLine line(std::size_t i) const {
    return context_->frame.double_line(rays_->origin(i), rays_->direction(i));
  }

  // Throws for the first ray that is none, where such are errors; counts them.
  std::uint64_t check(InvalidRays invalid) const;

  // Calls answer(first, last) for parts of the rays, from several threads.
  template <class Answer>
  QueryReport run(const QueryOptions& options, const Answer& answer) const {
    const QueryReport report{check(options.invalid)};
    for_each_slow_grain(rays_->size(), options.cancel, answer);
    return report;
  }

  // All hits of every ray.
  ExactHits all(std::uint32_t max_hits, const std::optional<Cancel>& cancel) const;

  // Of rays first and on: counts those that are kInDoubtCount (all_hits.h).
  void count_in_doubt(std::size_t first, std::span<std::uint32_t> counts,
                      const std::optional<Cancel>& cancel) const;
  // All hits of rays first and on, from those that the filter is sure of, which are named by reference.
  ExactHits settle(std::size_t first, const LocalHits& found, std::uint32_t max_hits,
                   const std::optional<Cancel>& cancel) const;

 private:
  const char* fault(std::size_t i) const;

  const QueryContext* context_;
  const RayArrays* rays_;
  DoubleScene scene_;
};

}  // namespace kdray::query
