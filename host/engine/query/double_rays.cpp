#include "engine/query/double_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "engine/query/check_rays.h"

namespace kdray::query {

namespace {

// Whether hits, sorted by t, are in that order for certain: t is off by less than two of its last places.
bool is_order_sure(std::span<const ExactHit> hits) {
  for (std::size_t k = 1; k < hits.size(); ++k)
    if (!(hits[k].t - hits[k - 1].t > 0x1p-49 * std::abs(hits[k].t))) return false;
  return true;
}

void put_first(std::size_t ray, std::span<const ExactHit> hits, std::uint32_t max_hits, ExactHits& to) {
  to.more[ray] = hits.size() > max_hits;
  to.put(ray, hits.first(std::min<std::size_t>(hits.size(), max_hits)));
}

}  // namespace

DoubleRays::DoubleRays(const QueryContext& context, const RayArrays& rays)
    : context_(&context), rays_(&rays), scene_(context.scene(), &context.table) {}

const char* DoubleRays::fault(std::size_t i) const {
  return fault_of(rays_->origin(i), rays_->direction(i), rays_->t_min(i), rays_->t_max(i));
}

std::optional<DoubleScene::Question> DoubleRays::question(std::size_t i, std::size_t place) const {
  if (rays_->mask(i) == 0 || fault(i) != nullptr) return std::nullopt;
  const auto ray = context_->frame.double_ray(rays_->origin(i), rays_->direction(i), rays_->double_t_min(i),
                                              rays_->double_t_max(i));
  if (!ray) return std::nullopt;
  return DoubleScene::Question{*ray, rays_->mask(i), place};
}

std::vector<DoubleScene::Question> DoubleRays::questions(std::size_t first, std::size_t n) const {
  std::vector<DoubleScene::Question> asked;
  asked.reserve(n);
  for (std::size_t i = first; i < first + n; ++i)
    if (const auto one = question(i, i - first)) asked.push_back(*one);
  return asked;
}

std::uint64_t DoubleRays::check(InvalidRays invalid) const {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < rays_->size(); ++i) {
    if (fault(i) == nullptr) continue;
    if (invalid == InvalidRays::error)
      throw Error(ErrorCode::input, fmt::format("ray {}: {}; take it out or repair it", i, fault(i)));
    ++count;
  }
  return count;
}

ExactHits DoubleRays::all(std::uint32_t max_hits, const std::optional<Cancel>& cancel) const {
  ExactHits exact(rays_->size());
  for_each_slow_grain(rays_->size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<std::vector<ExactHit>> hits(end - begin);
    scene_.all(questions(begin, end - begin), hits);
    for (std::size_t i = begin; i < end; ++i) put_first(i, hits[i - begin], max_hits, exact);
  });
  return exact;
}

void DoubleRays::count_in_doubt(std::size_t first, std::span<std::uint32_t> counts,
                                const std::optional<Cancel>& cancel) const {
  for_each_slow_grain(counts.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<DoubleScene::Question> in_doubt;
    for (std::size_t i = begin; i < end; ++i) {
      if (counts[i] != kInDoubtCount) continue;
      counts[i] = 0;
      if (const auto one = question(first + i, i)) in_doubt.push_back(*one);
    }
    scene_.count(in_doubt, counts);
  });
}

ExactHits DoubleRays::settle(std::size_t first, const LocalHits& found, std::uint32_t max_hits,
                             const std::optional<Cancel>& cancel) const {
  ExactHits exact(found.more.size());
  for_each_slow_grain(found.more.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> told(found.splits[end] - found.splits[begin]);
    std::vector<std::size_t> ray_of;
    ray_of.reserve(told.size());
    for (std::size_t i = begin; i < end; ++i)
      ray_of.insert(ray_of.end(), found.splits[i + 1] - found.splits[i], i);
    scene_.tell(
        told.size(), [&](std::size_t k) { return line(first + ray_of[k]); },
        [&](std::size_t k) { return found.primitive[found.splits[begin] + k] & KDRAY_REF_INDEX_MASK; },
        [&](std::size_t k, const ExactHit& hit) { told[k] = hit; });
    const auto hits_of = [&](std::size_t i) {
      return std::span(told).subspan(found.splits[i] - found.splits[begin],
                                     found.splits[i + 1] - found.splits[i]);
    };
    std::vector<DoubleScene::Question> in_doubt;
    std::vector<std::uint8_t> is_sure(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      const std::span<ExactHit> hits = hits_of(i);
      std::sort(hits.begin(), hits.end(), [](const ExactHit& a, const ExactHit& b) { return a.t < b.t; });
      is_sure[i - begin] = found.in_doubt[i] == 0 && found.more[i] == 0 && is_order_sure(hits);
      if (is_sure[i - begin]) continue;
      if (const auto one = question(first + i, i - begin)) in_doubt.push_back(*one);
    }
    std::vector<std::vector<ExactHit>> settled(end - begin);
    scene_.all(in_doubt, settled);
    for (std::size_t i = begin; i < end; ++i)
      is_sure[i - begin] ? exact.put(i, hits_of(i)) : put_first(i, settled[i - begin], max_hits, exact);
  });
  return exact;
}

}  // namespace kdray::query
