#include "engine/query/exact_rays.h"

#include <algorithm>
#include <cmath>

#include "engine/query/check_rays.h"
#include "engine/query/shared_rows.h"
#include "engine/query/surface.h"

namespace kdray::query {

// Where the ray begins: not so far off that it had to be moved to the scene.
std::optional<LocalLine> ExactRays::line_of(std::size_t i) const {
  const dvec3 origin = rays_->origin(i), direction = rays_->direction(i);
  const double t_min = rays_->t_min(i);
  if (fault_of(origin, direction, t_min, rays_->t_max(i)) != nullptr || rays_->mask(i) == 0)
    return std::nullopt;
  std::optional<LocalLine> line = context_->frame.line(origin, direction, true);
  if (!line || line->ahead != 0) return std::nullopt;
  if (t_min != 0) line->origin += std::scalbn(t_min, -line->exponent) * line->direction;
  return line;
}

bool ExactRays::begins_near(std::size_t i) const {
  const std::optional<LocalLine> line = line_of(i);
  return line && !context_->frame.is_outside(line->origin) && scene_.is_near(line->origin);
}

bool ExactRays::is_seen(const ExactHit& hit, std::uint32_t mask) const {
  const flatten::FlatScene& flat = context_->scene().flat;
  if (hit.instance != kNoInstance)
    return (context_->table.mask_of_instance(flat.instances[hit.instance].number) & mask) != 0;
  return (context_->table.mask_of(number_of(flat, hit.ref)) & mask) != 0;
}

void ExactRays::all_hits(std::size_t i, std::vector<ExactHit>& hits) const {
  const LocalLine line = *line_of(i);
  const double t_min = rays_->t_min(i), t_max = rays_->t_max(i);
  const std::uint32_t mask = rays_->mask(i);
  scene_.cross(line.origin, line.direction, hits);
  // One in the start point counts where t_min is 0.
  std::erase_if(hits, [&](ExactHit& hit) {
    if (t_min != 0 && hit.t == 0) return true;
    hit.t = t_min + std::scalbn(hit.t, line.exponent);
    return !(hit.t < t_max) || (context_->has_masks() && !is_seen(hit, mask));
  });
}

double ExactRays::distance(std::size_t i, std::uint32_t ref, std::uint32_t instance, float t) const {
  const std::optional<LocalLine> line = context_->frame.line(rays_->origin(i), rays_->direction(i), true);
  if (!line) return t;  // it meets nothing
  return distance(i, *line, {t, 0, 0, ref, instance});
}

double ExactRays::distance(std::size_t i, const LocalLine& line, const ExactHit& about) const {
  const double at = scene_.distance(line.origin, line.direction, about.ref, about.instance, about.t);
  return std::max(std::scalbn(line.ahead + at, line.exponent), rays_->t_min(i));
}

std::optional<ExactHit> ExactRays::closest(std::size_t i, const ExactHit& found) const {
  const std::optional<LocalLine> line = context_->frame.line(rays_->origin(i), rays_->direction(i), true);
  if (!line) return std::nullopt;
  ExactHit hit = found;
  hit.t = distance(i, *line, found);
  const double from_start = std::scalbn(hit.t - rays_->t_min(i), -line->exponent);
  const bool is_near = !(from_start * largest_component(line->direction) > ExactScene::kNear);
  return is_near || !allows(i, hit.t) ? closest_anew(i, *line) : hit;
}

std::optional<ExactHit> ExactRays::closest_anew(std::size_t i, const LocalLine& line) const {
  // From a little before t_min, since the place there is rounded.
  constexpr double kBefore = 0x1p-20;
  const double start = std::max(std::scalbn(rays_->t_min(i), -line.exponent) - line.ahead - kBefore, 0.0);
  std::vector<ExactHit> hits;
  scene_.cross(line.origin + start * line.direction, line.direction, hits);
  for (ExactHit& hit : hits) {
    hit.t += start;
    hit.t = distance(i, line, hit);
  }
  const std::uint32_t mask = rays_->mask(i);
  std::erase_if(hits, [&](const ExactHit& hit) {
    return !allows(i, hit.t) || (context_->has_masks() && !is_seen(hit, mask));
  });
  if (hits.empty()) return std::nullopt;
  scene_.sort(hits);
  return hits.front();
}

void ExactRays::count(std::size_t first, std::span<std::uint32_t> counts,
                      const std::optional<Cancel>& cancel) const {
  for_each_slow_grain(counts.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> hits;
    for (std::size_t i = begin; i < end; ++i) {
      if (!begins_near(first + i)) continue;
      all_hits(first + i, hits);
      counts[i] = static_cast<std::uint32_t>(hits.size());
    }
  });
}

ExactHits ExactRays::settle(std::size_t first, const LocalHits& found, std::uint32_t max_hits,
                            const std::optional<Cancel>& cancel) const {
  const std::size_t n = found.more.size();
  ExactHits exact(n);
  std::copy(found.more.begin(), found.more.end(), exact.more.begin());
  for_each_slow_grain(n, cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> hits;
    for (std::size_t i = begin; i < end; ++i) {
      if (begins_near(first + i)) {
        all_hits(first + i, hits);
        exact.more[i] = hits.size() > max_hits;
        exact.put(i, std::span(hits).first(std::min<std::size_t>(hits.size(), max_hits)));
        continue;
      }
      hits.clear();
      for (std::size_t k = found.splits[i]; k < found.splits[i + 1]; ++k) {
        const std::uint32_t instance = found.instance.empty() ? kNoInstance : found.instance[k];
        const double t = distance(first + i, found.primitive[k], instance, found.t[k]);
        hits.push_back({t, found.u[k], found.v[k], found.primitive[k], instance});
      }
      scene_.sort(hits);
      exact.put(i, hits);
    }
  });
  return exact;
}

}  // namespace kdray::query
