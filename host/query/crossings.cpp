#include "query/crossings.h"

#include <algorithm>

#include "base/error.h"
#include "query/all_hits.h"
#include "query/grains.h"

namespace kdray::query {

namespace {

// Rays whose hits are held at a time, beside the answer.
constexpr std::size_t kCollected = std::size_t{1} << 18;

// The rays of a chunk in the scene's own space, and their masks where primitives have some.
class CollectedRays {
 public:
  CollectedRays(const Asked& asked, const RayArrays& rays)
      : rays_(&rays), local_(rays, asked.frame), masked_(asked.target.masks() != nullptr) {}

  std::span<const Ray> take(std::size_t first, const QueryOptions& options) {
    throw_if_cancelled(options);
    const std::size_t n = std::min(kCollected, rays_->size() - first);
    taken_.resize(n);
    static_assert(sizeof(Ray) == sizeof(layout::QueryRay));
    local_.fill(first, n, reinterpret_cast<layout::QueryRay*>(taken_.data()));
    check_invalid(local_, options);
    masks_.resize(masked_ ? n : 0);
    for (std::size_t i = 0; i < masks_.size(); ++i) masks_[i] = rays_->mask(first + i);
    return taken_;
  }

  std::span<const std::uint32_t> masks() const { return masks_; }
  const LocalRays& local() const { return local_; }

 private:
  const RayArrays* rays_;
  LocalRays local_;
  bool masked_;
  std::vector<Ray> taken_;
  std::vector<std::uint32_t> masks_;
};

// Adds a chunk's hits to the answer.
void add(const Asked& asked, const LocalRays& local, const LocalHits& hits, std::size_t n_rays, AllHits& to) {
  const std::size_t before = to.t.size(), n = hits.t.size();
  for (std::size_t i = 1; i <= n_rays; ++i) to.splits.push_back(before + hits.splits[i]);
  to.more.insert(to.more.end(), hits.more.begin(), hits.more.end());
  to.u.insert(to.u.end(), hits.u.begin(), hits.u.end());
  to.v.insert(to.v.end(), hits.v.begin(), hits.v.end());
  to.t.resize(before + n);
  to.geometry.resize(before + n);
  to.primitive.resize(before + n);
  for_each_index(n_rays, [&](std::size_t i) {
    for (std::size_t k = hits.splits[i]; k < hits.splits[i + 1]; ++k) {
      const GeometryTable::Place place = asked.table.of(hits.primitive[k]);
      to.t[before + k] = local.world_t(i, hits.t[k]);
      to.geometry[before + k] = place.geometry;
      to.primitive[before + k] = place.primitive;
    }
  });
}

}  // namespace

QueryReport count(const Asked& asked, const Rays& rays, const WordsOut& out, const QueryOptions& options) {
  const RayArrays arrays(rays);
  check_out(out.size(), arrays.size(), "counts");
  CollectedRays collected(asked, arrays);
  const Sessions<Passes>::Borrowed passes = asked.sessions.crossings.borrow();
  std::vector<std::uint32_t> counts;
  for (std::size_t first = 0; first < arrays.size(); first += kCollected) {
    const std::span<const Ray> taken = collected.take(first, options);
    counts.resize(taken.size());
    count_hits(*passes, taken, {.masks = collected.masks()}, counts);
    if (!out.empty())
      out.fill(first, counts.size(), [&](std::size_t ray) { return std::array{counts[ray - first]}; });
  }
  return {collected.local().n_invalid()};
}

AllHits all(const Asked& asked, const Rays& rays, const AllHitsOptions& options) {
  const RayArrays arrays(rays);
  CollectedRays collected(asked, arrays);
  AllHits hits;
  hits.splits.reserve(arrays.size() + 1);
  hits.splits.push_back(0);
  const Sessions<Passes>::Borrowed passes = asked.sessions.crossings.borrow();
  LocalHits found;
  for (std::size_t first = 0; first < arrays.size(); first += kCollected) {
    const std::span<const Ray> taken = collected.take(first, options);
    all_hits(*passes, taken, {.max_hits = options.max_hits, .masks = collected.masks()}, found);
    add(asked, collected.local(), found, taken.size(), hits);
  }
  hits.report.invalid = collected.local().n_invalid();
  return hits;
}

}  // namespace kdray::query
