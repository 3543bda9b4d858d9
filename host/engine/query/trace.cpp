#include "engine/query/trace.h"

#include <algorithm>
#include <atomic>
#include <deque>

#include "base/timer.h"
#include "engine/query/check_rays.h"
#include "engine/query/grains.h"
#include "engine/query/local_rays.h"
#include "engine/query/session.h"
#include "engine/query/surface.h"

namespace kdray::query {

namespace {

static_assert(sizeof(Hit) == sizeof(layout::QueryHit));

// Rays in one launch: 512 MiB of them; and for a GPU, whose watchdog may end what takes seconds.
constexpr std::size_t kRaysPerLaunch = std::size_t{1} << 24, kBoundedLaunch = std::size_t{1} << 20;

Rays rays_of(std::span<const Ray> rays) {
  const std::size_t n = rays.size();
  const Ray& first = rays.front();
  return {.origins = {first.origin, n, sizeof(Ray)},
          .directions = {first.direction, n, sizeof(Ray)},
          .t_min = {&first.t_min, n, sizeof(Ray)},
          .t_max = {&first.t_max, n, sizeof(Ray)}};
}

double units_of(const Target& target) {
  return static_cast<double>(target.context.info().compute_units) /
         static_cast<double>(target.context.n_sub_devices());
}

// The rays that a target traces at a time, of so many in all: `share` of them, as far as they fit.
std::size_t chunk_of(const Target& target, std::size_t n_rays, double share) {
  const std::size_t fair = static_cast<std::size_t>(static_cast<double>(n_rays) * share) + 1;
  return std::min({fair, n_rays, target.global ? kBoundedLaunch : kRaysPerLaunch,
                   static_cast<std::size_t>(target.context.info().max_allocation / sizeof(Ray))});
}

// A target at work on its part of a round.
class Part {
 public:
  Part(const Target& target, const RayArrays& rays, const LocalFrame& frame, std::size_t chunk)
      : session_(target, chunk), local_(rays, frame) {
    session_.warm_up(chunk);
  }

  // Takes rays from `first` on: returns where the rest begins.
  std::size_t load(std::size_t first, std::size_t n_rays, bool any_hit) {
    first_ = first;
    any_hit_ = any_hit;
    const std::size_t n = std::min(session_.chunk(), n_rays - first);
    local_.fill(first, n, session_.rays());
    session_.load(n, any_hit, false);
    session_.finish();
    return first + n;
  }
  void launch() { session_.launch(); }
  void finish() { session_.finish(); }

  void take(Traced& traced) {
    const std::span<const layout::QueryHit> hits = session_.wait();
    std::atomic<bool> failed{false};
    for_each_index(hits.size(), [&](std::size_t i) {
      const layout::QueryHit& hit = hits[i];
      if (hit.primitive == kFailedWalk) failed = true;
      // What was hit at all has t = 0.
      const float t = any_hit_ ? hit.t : static_cast<float>(local_.world_t(i, hit.t));
      traced.hits[first_ + i] = {t, hit.primitive, hit.u, hit.v};
    });
    if (failed) throw_failed_walk();
    std::ranges::copy(session_.instances(), traced.instances.begin() + static_cast<std::ptrdiff_t>(first_));
  }

 private:
  Session session_;
  LocalRays local_;
  std::size_t first_ = 0;
  bool any_hit_ = false;
};

void trace_round(std::span<Part* const> parts, std::vector<double>& seconds) {
  for (double& s : seconds) {
    const Timer timer;
    for (Part* const part : parts) part->launch();
    for (Part* const part : parts) part->finish();
    s += timer.seconds();
  }
}

}  // namespace

Traced trace(std::span<const Target> targets, std::span<const Ray> rays, const TraceOptions& options) {
  check_rays(rays);
  const prepare::Prepared& scene = targets.front().scene;
  const bool placed = !scene.flat.instances.empty();
  Traced traced{std::vector<Hit>(rays.size()), std::vector<std::uint32_t>(placed ? rays.size() : 0),
                std::vector<double>(static_cast<std::size_t>(std::max(options.repeat, 1)))};
  if (rays.empty()) return traced;
  const RayArrays arrays(rays_of(rays));
  const LocalFrame frame(scene.geometry);
  double units = 0;
  for (const Target& target : targets) units += units_of(target);
  std::deque<Part> parts;
  for (const Target& target : targets)
    parts.emplace_back(target, arrays, frame, chunk_of(target, rays.size(), units_of(target) / units));
  for (std::size_t first = 0; first < rays.size();) {
    std::vector<Part*> at_work;
    for (auto part = parts.begin(); part != parts.end() && first < rays.size(); ++part) {
      first = part->load(first, rays.size(), options.any_hit);
      at_work.push_back(&*part);
    }
    trace_round(at_work, traced.seconds);
    for (Part* const part : at_work) part->take(traced);
  }
  name_places(scene.flat, traced.instances);
  return traced;
}

Traced trace(const Target& target, std::span<const Ray> rays, const TraceOptions& options) {
  return trace(std::span(&target, 1), rays, options);
}

}  // namespace kdray::query
