#include "query/all_hits.h"

#include <algorithm>
#include <memory>

#include "query/check_rays.h"
#include "query/hit_lists.h"

namespace kdray::query {

namespace {

using layout::QueryHit;
using layout::QuerySpan;

// Hits that there is room for in a launch: 8 MiB, which stay in a cache on their way to where they are packed.
// (With 32 MiB, memory that was touched for the first time took a tenth of the time.)
constexpr std::size_t kLaunchHits = std::size_t{1} << 19;
// Of these a ray has room for so many in its first pass: more where more than one ray of sixteen had more.
constexpr std::uint32_t kLeastFirst = 8, kMostFirst = 64;
// The same in later passes, which take the rays that have more.
constexpr std::uint32_t kLeastLater = 64, kMostLater = 4096;

// The passes of rays that are taken chunk by chunk.
class Passes {
 public:
  Passes(const Target& target, std::size_t n_rays, const RaysSeen& seen, const CollectOptions& options)
      : target_(target),
        seen_(seen),
        max_hits_(options.max_hits),
        capacity_(std::clamp(options.max_hits, 1u, kLeastFirst)),
        traversal_(options.traversal == Traversal::automatic && target.global ? Traversal::wide
                                                                              : options.traversal),
        near_rays_(target.scene.geometry.space),
        first_(target, traversal_, near_rays_.kernel_space(), std::min(n_rays, kLaunchHits / capacity_),
               std::min(n_rays * capacity_, kLaunchHits)) {}

  // How many of the rays that are left the next chunk has.
  std::size_t next_chunk(std::size_t left) const { return std::min(left, first_.most_hits() / capacity_); }
  HitLists& first_lists() { return first_; }
  const NearRays& near_rays() const { return near_rays_; }

  // The first pass of a chunk: what it found of each ray.
  std::span<const QuerySpan> first(std::span<const Ray> rays) {
    rays_ = near_rays_.all_near(seen_.farthest) ? rays : near_rays_.take(rays);
    const std::span<const QuerySpan> spans = first_.find(rays_, !seen_.ordinary, {}, capacity_);
    const auto n_more = std::count_if(spans.begin(), spans.end(), [](const QuerySpan& s) { return s.more; });
    if (static_cast<std::size_t>(n_more) > spans.size() / 16)
      capacity_ =
          std::min({2 * capacity_, kMostFirst, max_hits_, static_cast<std::uint32_t>(first_.most_hits())});
    return spans;
  }

  // What further passes find of the chunk's rays whose span says that there is more, until max_hits:
  // found(i, hits, more) for ray i in the order of its hits. `spans` is what first() returned.
  template <class Found>
  void others(std::span<const QuerySpan> spans, bool want_hits, const Found& found) {
    std::vector<Rest> rest;
    for (std::uint32_t i = 0; i < spans.size(); ++i)
      if (spans[i].more != 0 && spans[i].n_hits < max_hits_) rest.push_back({i, spans[i].n_hits, spans[i]});
    while (!rest.empty()) {
      std::vector<Rest> still;
      for (std::size_t first = 0; first < rest.size(); first += kLaunchHits / kLeastLater) {
        const std::size_t n = std::min(rest.size() - first, kLaunchHits / kLeastLater);
        pass(std::span(rest).subspan(first, n), want_hits, found, still);
      }
      rest.swap(still);
    }
  }

 private:
  struct Rest {
    std::uint32_t ray, n_hits;
    QuerySpan span;
  };

  template <class Found>
  void pass(std::span<const Rest> rest, bool want_hits, const Found& found, std::vector<Rest>& still) {
    if (!later_)
      later_ = std::make_unique<HitLists>(target_, traversal_, near_rays_.kernel_space(),
                                          kLaunchHits / kLeastLater, kLaunchHits);
    const auto capacity = static_cast<std::uint32_t>(
        std::clamp<std::size_t>(kLaunchHits / rest.size(), kLeastLater, kMostLater));
    std::vector<Ray> rays;
    std::vector<QuerySpan> after;
    for (const Rest& r : rest) {
      rays.push_back(rays_[r.ray]);
      after.push_back(r.span);
    }
    const std::span<const QuerySpan> spans = later_->find(rays, !seen_.ordinary, after, capacity);
    const std::span<const QueryHit> hits = want_hits ? later_->read() : std::span<const QueryHit>();
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const std::uint32_t n = std::min(spans[k].n_hits, max_hits_ - rest[k].n_hits);
      const bool more = spans[k].more != 0 || n < spans[k].n_hits;
      found(rest[k].ray, want_hits ? hits.subspan(k * capacity, n) : hits, n, more);
      if (spans[k].more != 0 && n == spans[k].n_hits && rest[k].n_hits + n < max_hits_)
        still.push_back({rest[k].ray, rest[k].n_hits + n, spans[k]});
    }
  }

  const Target& target_;
  RaysSeen seen_;
  std::uint32_t max_hits_, capacity_;
  Traversal traversal_;
  NearRays near_rays_;
  HitLists first_;
  std::unique_ptr<HitLists> later_;
  std::span<const Ray> rays_;  // of the chunk in work
};

// Hits of a ray that a later pass found.
struct Later {
  std::uint32_t ray;
  std::vector<QueryHit> hits;
  bool more;
};

void put(const QueryHit& hit, const HitArrays& to, std::size_t at) {
  to.t[at] = hit.t;
  to.primitive[at] = static_cast<std::uint32_t>(hit.primitive);
  to.u[at] = hit.u;
  to.v[at] = hit.v;
}

// Adds chunk by chunk to the answer.
class Collection {
 public:
  Collection(AllHits& to, Passes& passes, std::uint32_t max_hits)
      : to_(to), passes_(passes), max_hits_(max_hits) {}

  void add(std::span<const Ray> rays) {
    const std::span<const QuerySpan> spans = passes_.first(rays);
    later_.clear();
    passes_.others(spans, true,
                   [&](std::uint32_t i, std::span<const QueryHit> hits, std::uint32_t n, bool more) {
                     later_.push_back({i, {hits.begin(), hits.begin() + n}, more});
                   });
    // A ray's passes stay in their order.
    std::stable_sort(later_.begin(), later_.end(),
                     [](const Later& a, const Later& b) { return a.ray < b.ray; });
    const std::size_t n_first = place(spans);
    later_.empty() ? fill(n_first) : fill_between(n_first);
    give_back();
    n_rays_ += rays.size();
  }

 private:
  // Makes room for the chunk's hits, and says where each ray's of the first pass lie among themselves: how
  // many these are.
  std::size_t place(std::span<const QuerySpan> spans) {
    const std::size_t first = to_.t.size();
    places_.resize(spans.size());
    std::uint32_t n_first = 0;
    std::size_t n = first;
    auto later = later_.begin();
    for (std::uint32_t i = 0; i < spans.size(); ++i) {
      places_[i] = n_first;
      const std::uint32_t n_here = std::min(spans[i].n_hits, max_hits_);
      n_first += n_here;
      n += n_here;
      bool more = spans[i].more != 0 || n_here < spans[i].n_hits;
      for (; later != later_.end() && later->ray == i; ++later) {
        n += later->hits.size();
        more = later->more;
      }
      to_.splits[n_rays_ + i + 1] = n;
      to_.more[n_rays_ + i] = more;
    }
    make_room(first, n, spans.size());
    return n_first;
  }

  // For all hits that there will be, if the other chunks have as many.
  void make_room(std::size_t first, std::size_t n, std::size_t n_rays) {
    const double all = 1.05 * static_cast<double>(n) * static_cast<double>(to_.more.size()) /
                       static_cast<double>(n_rays_ + n_rays);
    const auto grow = [&](auto& array) {
      if (array.capacity() < n) array.reserve(std::max(n, static_cast<std::size_t>(all)));
      array.resize(n);
      return array.data() + first;
    };
    chunk_ = {grow(to_.t), grow(to_.primitive), grow(to_.u), grow(to_.v)};
  }

  void fill(std::size_t n) {
    if (n > 0) passes_.first_lists().pack(places_, n, chunk_);
  }

  // The hits of the first pass spread out, those of later ones between them.
  void fill_between(std::size_t n) {
    RawVector<float> t(n), u(n), v(n);
    RawVector<std::uint32_t> primitive(n);
    if (n > 0) passes_.first_lists().pack(places_, n, {t.data(), primitive.data(), u.data(), v.data()});
    std::size_t at = 0;
    auto later = later_.begin();
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      const std::size_t end = i + 1 < places_.size() ? places_[i + 1] : n;
      for (std::size_t k = places_[i]; k < end; ++k)
        put({t[k], static_cast<std::int32_t>(primitive[k]), u[k], v[k]}, chunk_, at++);
      for (; later != later_.end() && later->ray == i; ++later)
        for (const QueryHit& hit : later->hits) put(hit, chunk_, at++);
    }
  }

  // The distances of rays that were begun anew.
  void give_back() {
    const NearRays& near_rays = passes_.near_rays();
    if (!near_rays.has_moved()) return;
    for (std::size_t i = 0; i < places_.size(); ++i)
      for (std::uint64_t k = to_.splits[n_rays_ + i]; k < to_.splits[n_rays_ + i + 1]; ++k)
        to_.t[k] = near_rays.given_back(i, to_.t[k]);
  }

  AllHits& to_;
  Passes& passes_;
  std::uint32_t max_hits_;
  std::size_t n_rays_ = 0;             // before the chunk
  HitArrays chunk_{};                  // the chunk's in the answer
  std::vector<std::uint32_t> places_;  // of the chunk's rays
  std::vector<Later> later_;
};

}  // namespace

AllHits all_hits(const Target& target, std::span<const Ray> rays, const CollectOptions& options) {
  const RaysSeen seen = look_at(rays);
  if (!options.faulty_miss) refuse_faulty(rays, seen);
  AllHits all;
  all.splits.resize(rays.size() + 1);
  all.splits[0] = 0;
  all.more.resize(rays.size());
  if (rays.empty()) return all;
  Passes passes(target, rays.size(), seen, options);
  Collection collection(all, passes, options.max_hits);
  for (std::size_t first = 0, n = 0; first < rays.size(); first += n) {
    n = passes.next_chunk(rays.size() - first);
    collection.add(rays.subspan(first, n));
  }
  return all;
}

std::vector<std::uint32_t> count_hits(const Target& target, std::span<const Ray> rays,
                                      const CollectOptions& options) {
  const RaysSeen seen = look_at(rays);
  if (!options.faulty_miss) refuse_faulty(rays, seen);
  std::vector<std::uint32_t> counts(rays.size());
  if (rays.empty()) return counts;
  Passes passes(target, rays.size(), seen, options);
  for (std::size_t first = 0, n = 0; first < rays.size(); first += n) {
    n = passes.next_chunk(rays.size() - first);
    const std::span<const QuerySpan> spans = passes.first(rays.subspan(first, n));
    for (std::size_t i = 0; i < n; ++i) counts[first + i] = std::min(spans[i].n_hits, options.max_hits);
    passes.others(spans, false, [&](std::uint32_t i, std::span<const QueryHit>, std::uint32_t more, bool) {
      counts[first + i] += more;
    });
  }
  return counts;
}

}  // namespace kdray::query
