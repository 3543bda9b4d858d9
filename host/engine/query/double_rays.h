// What    Rays of a program against a scene of doubles (double_scene.h): each on the host, in parallel.
// Errors  As kdray/query.h says of rays that are none.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "base/error.h"
#include "engine/query/check_rays.h"
#include "engine/query/double_scene.h"
#include "engine/query/grains.h"
#include "engine/query/queries.h"
#include "engine/query/shared_rows.h"

namespace kdray::query {

class DoubleRays {
 public:
  DoubleRays(const QueryContext& context, const RayArrays& rays)
      : context_(&context), rays_(&rays), scene_(context.scene(), context.table) {}

  const DoubleScene& scene() const { return scene_; }

  // Of these rays, but for those that meet nothing; places count from the first.
  std::vector<DoubleScene::Question> questions(std::size_t first, std::size_t n) const {
    std::vector<DoubleScene::Question> asked;
    asked.reserve(n);
    for (std::size_t i = first; i < first + n; ++i) {
      if (rays_->mask(i) == 0 || fault(i) != nullptr) continue;
      if (const auto ray = context_->frame.double_ray(rays_->origin(i), rays_->direction(i), rays_->t_min(i),
                                                      rays_->t_max(i)))
        asked.push_back({*ray, rays_->mask(i), i - first});
    }
    return asked;
  }

  // Throws for the first of these rays that is none, where such are errors; counts them.
  std::uint64_t check(std::size_t first, std::size_t n, InvalidRays invalid) const {
    std::atomic<std::uint64_t> count{0};
    for_each_grain(n, [&](std::size_t begin, std::size_t end) {
      std::uint64_t faults = 0;
      for (std::size_t i = first + begin; i < first + end; ++i) faults += fault(i) != nullptr;
      count += faults;
    });
    if (count > 0 && invalid == InvalidRays::error) {
      std::size_t i = first;
      while (fault(i) == nullptr) ++i;
      throw Error(ErrorCode::input, fmt::format("ray {}: {}; take it out or repair it", i, fault(i)));
    }
    return count;
  }

  // Calls answer(first, last) for parts of the rays, from several threads.
  template <class Answer>
  QueryReport run(const QueryOptions& options, const Answer& answer) const {
    constexpr std::size_t kAtOnce = std::size_t{1} << 16;
    QueryReport report;
    for (std::size_t first = 0; first < rays_->size(); first += kAtOnce) {
      const std::size_t n = std::min(kAtOnce, rays_->size() - first);
      report.invalid += check(first, n, options.invalid);
      for_each_slow_grain(n, options.cancel,
                          [&](std::size_t begin, std::size_t end) { answer(first + begin, first + end); });
    }
    return report;
  }

 private:
  const char* fault(std::size_t i) const {
    return fault_of(rays_->origin(i), rays_->direction(i), rays_->t_min(i), rays_->t_max(i));
  }

  const QueryContext* context_;
  const RayArrays* rays_;
  DoubleScene scene_;
};

}  // namespace kdray::query
