#include "query/all_hits.h"

#include <algorithm>

#include "query/passes.h"

namespace kdray::query {

namespace {

using layout::QuerySpan;

std::span<const std::uint32_t> masks_of(const CollectOptions& options, std::size_t first, std::size_t n) {
  return options.masks.empty() ? options.masks : options.masks.subspan(first, n);
}

// Hits of a ray that a later pass found.
struct Later {
  std::uint32_t ray;
  Hits hits;
  bool more;
};

// Adds chunk by chunk to the answer.
class Collection {
 public:
  Collection(LocalHits& to, Passes& passes, std::uint32_t max_hits)
      : to_(to), passes_(passes), max_hits_(max_hits) {}

  void add(std::span<const Ray> rays, std::span<const std::uint32_t> masks) {
    const std::span<const QuerySpan> spans = passes_.first(rays, masks);
    later_.clear();
    passes_.others(spans, true, [&](std::uint32_t i, Hits&& hits, std::uint32_t, bool more) {
      later_.push_back({i, std::move(hits), more});
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
    Hits first(n);
    if (n > 0) passes_.first_lists().pack(places_, n, first.arrays());
    std::size_t at = 0;
    auto later = later_.begin();
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
      const std::size_t end = i + 1 < places_.size() ? places_[i + 1] : n;
      first.copy(places_[i], end - places_[i], chunk_, at);
      at += end - places_[i];
      for (; later != later_.end() && later->ray == i; ++later) {
        later->hits.copy(0, later->hits.size(), chunk_, at);
        at += later->hits.size();
      }
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

  LocalHits& to_;
  Passes& passes_;
  std::uint32_t max_hits_;
  std::size_t n_rays_ = 0;             // before the chunk
  HitArrays chunk_{};                  // the chunk's in the answer
  std::vector<std::uint32_t> places_;  // of the chunk's rays
  std::vector<Later> later_;
};

}  // namespace

void all_hits(Passes& passes, std::span<const Ray> rays, const CollectOptions& options, LocalHits& all) {
  all.splits.resize(rays.size() + 1);
  all.splits[0] = 0;
  all.more.resize(rays.size());
  all.t.clear(), all.primitive.clear(), all.u.clear(), all.v.clear();
  if (rays.empty()) return;
  passes.begin(rays.size(), options);
  Collection collection(all, passes, options.max_hits);
  for (std::size_t first = 0, n = 0; first < rays.size(); first += n) {
    n = passes.next_chunk(rays.size() - first);
    collection.add(rays.subspan(first, n), masks_of(options, first, n));
  }
}

void all_hits(const Target& target, std::span<const Ray> rays, const CollectOptions& options,
              LocalHits& all) {
  Passes passes(target, options.traversal);
  all_hits(passes, rays, options, all);
}

LocalHits all_hits(const Target& target, std::span<const Ray> rays, const CollectOptions& options) {
  LocalHits all;
  all_hits(target, rays, options, all);
  return all;
}

void count_hits(Passes& passes, std::span<const Ray> rays, const CollectOptions& options,
                std::span<std::uint32_t> counts) {
  if (rays.empty()) return;
  passes.begin(rays.size(), options);
  for (std::size_t first = 0, n = 0; first < rays.size(); first += n) {
    n = passes.next_chunk(rays.size() - first);
    const std::span<const QuerySpan> spans =
        passes.first(rays.subspan(first, n), masks_of(options, first, n));
    for (std::size_t i = 0; i < n; ++i) counts[first + i] = std::min(spans[i].n_hits, options.max_hits);
    passes.others(spans, false,
                  [&](std::uint32_t i, const Hits&, std::uint32_t more, bool) { counts[first + i] += more; });
  }
}

std::vector<std::uint32_t> count_hits(const Target& target, std::span<const Ray> rays,
                                      const CollectOptions& options) {
  std::vector<std::uint32_t> counts(rays.size());
  Passes passes(target, options.traversal);
  count_hits(passes, rays, options, counts);
  return counts;
}

}  // namespace kdray::query
