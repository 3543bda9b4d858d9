#include "query/crossings.h"

#include <tbb/task_group.h>

#include <algorithm>

#include "base/memory.h"
#include "query/all_hits.h"
#include "query/grains.h"

namespace kdray::query {

namespace {

// Rays whose hits are held at a time, beside the answer.
constexpr std::size_t kCollected = std::size_t{1} << 16;

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

// The answer, to which chunks' hits are added in turn.
class Answer {
 public:
  Answer(const Asked& asked, std::size_t n_rays) : asked_(&asked), n_all_(n_rays) {
    hits_.splits.reserve(n_rays + 1);
    hits_.splits.push_back(0);
    hits_.more.reserve(n_rays);
  }

  void add(const LocalRays& local, const LocalHits& found) {
    const std::size_t n_rays = found.more.size(), n = found.t.size(), before = hits_.t.size();
    n_rays_ += n_rays;
    for (std::size_t i = 1; i <= n_rays; ++i) hits_.splits.push_back(before + found.splits[i]);
    hits_.more.insert(hits_.more.end(), found.more.begin(), found.more.end());
    make_room(before + n);
    for_each_index(n_rays, [&](std::size_t i) {
      for (std::size_t k = found.splits[i]; k < found.splits[i + 1]; ++k) {
        const GeometryTable::Place place = place_of(found, k);
        hits_.t[before + k] = local.world_t(i, found.t[k]);
        hits_.geometry[before + k] = place.geometry;
        hits_.primitive[before + k] = place.primitive;
        hits_.u[before + k] = found.u[k];
        hits_.v[before + k] = found.v[k];
        hits_.instance[before + k] = instance_of(found, k);
      }
    });
  }

  AllHits take(std::uint64_t n_invalid) {
    hits_.report.invalid = n_invalid;
    return std::move(hits_);
  }

 private:
  // For n hits; and at once for all that there will be, if the other rays have as many.
  void make_room(std::size_t n) {
    const double all =
        1.05 * static_cast<double>(n) * static_cast<double>(n_all_) / static_cast<double>(n_rays_);
    const auto grow = [&](auto& array) {
      if (array.capacity() < n) {
        array.reserve(std::max(n, static_cast<std::size_t>(all)));
        prefer_large_pages(array.data(), array.capacity() * sizeof(array[0]));
      }
      array.resize(n);
    };
    grow(hits_.t), grow(hits_.geometry), grow(hits_.primitive), grow(hits_.u), grow(hits_.v);
    grow(hits_.instance);
  }

  static std::uint32_t listed(const LocalHits& found, std::size_t k) {
    return found.instance.empty() ? kNoInstance : found.instance[k];
  }
  GeometryTable::Place place_of(const LocalHits& found, std::size_t k) const {
    const std::uint32_t instance = listed(found, k);
    if (instance == kNoInstance) return asked_->table.of(found.primitive[k]);
    return {asked_->table.of_instance(instance).geometry, found.primitive[k]};
  }
  std::uint32_t instance_of(const LocalHits& found, std::size_t k) const {
    const std::uint32_t instance = listed(found, k);
    return instance == kNoInstance ? instance : asked_->table.of_instance(instance).instance;
  }

  const Asked* asked_;
  std::size_t n_all_, n_rays_ = 0;  // rays there are, and that were added
  AllHits hits_;
};

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

// While a chunk is traced, the hits of the one before it are added to the answer.
AllHits all(const Asked& asked, const Rays& rays, const AllHitsOptions& options) {
  const RayArrays arrays(rays);
  struct Chunk {
    Chunk(const Asked& asked, const RayArrays& rays) : rays(asked, rays) {}
    CollectedRays rays;
    LocalHits found;
  };
  Chunk chunks[2] = {{asked, arrays}, {asked, arrays}};
  Answer answer(asked, arrays.size());
  const Sessions<Passes>::Borrowed passes = asked.sessions.crossings.borrow();
  tbb::task_group adding;
  try {
    for (std::size_t first = 0, turn = 0; first < arrays.size(); first += kCollected, turn ^= 1) {
      Chunk& chunk = chunks[turn];
      const std::span<const Ray> taken = chunk.rays.take(first, options);
      all_hits(*passes, taken, {.max_hits = options.max_hits, .masks = chunk.rays.masks()}, chunk.found);
      adding.wait();
      const auto add = [&answer, &chunk] { answer.add(chunk.rays.local(), chunk.found); };
      first + taken.size() < arrays.size() ? adding.run(add) : add();
    }
  } catch (...) {
    adding.cancel();
    adding.wait();
    throw;
  }
  return answer.take(chunks[0].rays.local().n_invalid() + chunks[1].rays.local().n_invalid());
}

}  // namespace kdray::query
