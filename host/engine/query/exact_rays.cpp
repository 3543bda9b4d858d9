#include "engine/query/exact_rays.h"

#include <algorithm>
#include <cmath>

#include "engine/query/check_rays.h"
#include "engine/query/shared_rows.h"
#include "engine/query/surface.h"

namespace kdray::query {

namespace {

constexpr double kFarthest = 0x1p100;  // in local lengths: no scene reaches as far

// Where to look for what a line crosses above t_min, in multiples of its direction: a little before, since
// the place there is rounded, and no farther back than a scene may reach from where a line begins.
double start_of(const LocalLine& line, double t_min) {
  constexpr double kBefore = 0x1p-20, kReach = 16 * kLocalReach;
  const double least = t_min < 0 ? -kReach / largest_component(line.direction) : 0;
  return std::max(std::scalbn(t_min, -line.exponent) - line.ahead - kBefore, least);
}

}  // namespace

std::optional<LocalLine> ExactRays::line_of(std::size_t i) const {
  const dvec3 origin = rays_->origin(i), direction = rays_->direction(i);
  const double t_min = rays_->t_min(i), t_max = rays_->t_max(i);
  if (!(t_min < t_max) || fault_of(origin, direction, t_min, t_max) != nullptr || rays_->mask(i) == 0)
    return std::nullopt;
  return context_->frame.line(origin, direction, true);
}

bool ExactRays::is_near(const LocalLine& line, double t) const {
  const double local = context_->frame.local_t(line, t) - line.ahead;
  if (!(std::abs(local) <= kFarthest)) return false;
  const dvec3 place = line.origin + local * line.direction;
  return !context_->frame.is_outside(place) && scene_.is_near(place);
}

// Most rays that have missed do.
bool ExactRays::ends_outside(std::size_t i) const {
  const double t_max = rays_->t_max(i);
  if (t_max == HUGE_VAL) return true;
  const dvec3 origin = context_->frame.space().local(rays_->origin(i)),
              way = t_max * context_->frame.space().scale * rays_->direction(i);
  constexpr double kPrecise = 0x1p30;  // farther off rounding counts
  return largest_component(origin) < kPrecise && largest_component(way) < kPrecise &&
         context_->frame.is_outside(origin + way);
}

bool ExactRays::has_end_near(std::size_t i, const LocalLine& line) const {
  return is_near(line, rays_->t_min(i)) || is_near(line, rays_->t_max(i));
}

bool ExactRays::is_seen(const ExactHit& hit, std::uint32_t mask) const {
  const flatten::FlatScene& flat = context_->scene().flat;
  if (hit.instance != kNoInstance)
    return (context_->table.mask_of_instance(flat.instances[hit.instance].number) & mask) != 0;
  return (context_->table.mask_of(number_of(flat, hit.ref)) & mask) != 0;
}

void ExactRays::cross(std::size_t i, const LocalLine& line, double most, std::vector<ExactHit>& hits) const {
  constexpr double kBeyond = 0x1p-10;  // more than boxes and hits are rounded by
  const double start = start_of(line, rays_->t_min(i));
  const double end = std::scalbn(most, -line.exponent) - line.ahead - start;
  scene_.cross(line.origin + start * line.direction, line.direction, end * (1 + kBeyond) + kBeyond, hits);
  const std::uint32_t mask = rays_->mask(i);
  std::erase_if(hits, [&](ExactHit& hit) {
    hit.t = distance(i, line, {hit.t + start, hit.u, hit.v, hit.ref, hit.instance});
    return !(hit.t < rays_->t_max(i)) || (context_->has_masks() && !is_seen(hit, mask));
  });
}

void ExactRays::all_hits(std::size_t i, const LocalLine& line, std::vector<ExactHit>& hits) const {
  cross(i, line, rays_->t_max(i), hits);
  const double t_min = rays_->t_min(i);
  // One in the start point counts where t_min is 0.
  if (t_min != 0) std::erase_if(hits, [&](const ExactHit& hit) { return hit.t <= t_min; });
  scene_.sort(hits);
}

double ExactRays::distance(std::size_t i, const LocalLine& line, const ExactHit& about) const {
  const double at = scene_.distance(line.origin, line.direction, about.ref, about.instance, about.t);
  return std::max(context_->frame.caller_t(line, line.ahead + at), rays_->t_min(i));
}

std::optional<ExactHit> ExactRays::closest(std::size_t i, const std::optional<ExactHit>& found) const {
  const double t_min = rays_->t_min(i), t_max = rays_->t_max(i);
  if (!found && ends_outside(i)) return std::nullopt;
  const std::optional<LocalLine> line =
      found ? context_->frame.line(rays_->origin(i), rays_->direction(i), true) : line_of(i);
  if (!line) return std::nullopt;
  std::optional<ExactHit> hit = found;
  if (hit) hit->t = distance(i, *line, *hit);
  // Floats can't tell what lies within kNear of an end of the ray.
  const double longest = largest_component(line->direction);
  const auto are_apart = [&](double t, double end) {
    return context_->frame.local_t(*line, end - t) * longest > ExactScene::kNear;
  };
  const bool in_doubt = (hit && !(are_apart(t_min, hit->t) && hit->t < t_max)) ||
                        (!(hit && are_apart(hit->t, t_max)) && is_near(*line, t_max));
  return in_doubt ? closest_anew(i, *line, hit && hit->t > t_min && hit->t < t_max ? hit->t : t_max) : hit;
}

std::optional<ExactHit> ExactRays::closest_anew(std::size_t i, const LocalLine& line, double most) const {
  const double t_min = rays_->t_min(i), t_max = rays_->t_max(i);
  std::vector<ExactHit> hits;
  cross(i, line, most, hits);
  std::erase_if(hits, [&](const ExactHit& hit) { return hit.t <= t_min; });
  if (hits.empty()) return most < t_max ? closest_anew(i, line, t_max) : std::nullopt;
  scene_.sort(hits);
  return hits.front();
}

void ExactRays::count(std::size_t first, std::span<std::uint32_t> counts,
                      const std::optional<Cancel>& cancel) const {
  for_each_slow_grain(counts.size(), cancel, [&](std::size_t begin, std::size_t end) {
    std::vector<ExactHit> hits;
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<LocalLine> line = line_of(first + i);
      if (!line || !has_end_near(first + i, *line)) continue;
      all_hits(first + i, *line, hits);
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
      const std::optional<LocalLine> line = line_of(first + i);
      if (line && has_end_near(first + i, *line)) {
        all_hits(first + i, *line, hits);
        exact.more[i] = hits.size() > max_hits;
        exact.put(i, std::span(hits).first(std::min<std::size_t>(hits.size(), max_hits)));
        continue;
      }
      hits.clear();
      for (std::size_t k = found.splits[i]; k < found.splits[i + 1]; ++k) {
        const std::uint32_t instance = found.instance.empty() ? kNoInstance : found.instance[k];
        hits.push_back({found.t[k], found.u[k], found.v[k], found.primitive[k], instance});
        if (line) hits.back().t = distance(first + i, *line, hits.back());
      }
      scene_.sort(hits);
      exact.put(i, hits);
    }
  });
  return exact;
}

}  // namespace kdray::query
