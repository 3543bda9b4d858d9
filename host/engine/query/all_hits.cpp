#include "engine/query/all_hits.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "engine/query/passes.h"
#include "engine/query/surface.h"

namespace kdray::query {

namespace {

using layout::QuerySpan;

std::span<const std::uint32_t> masks_of(const CollectOptions& options, std::size_t first, std::size_t n) {
  return options.masks.empty() ? options.masks : options.masks.subspan(first, n);
}

// Adds chunk by chunk to the answer.
class Collection {
 public:
  Collection(LocalHits& to, Passes& passes, const CollectOptions& options)
      : to_(to),
        passes_(passes),
        max_hits_(options.max_hits),
        as_refs_(options.as_refs),
        at_once_(options.at_once) {}

  // False, and nothing was added: there are more than `at_once_` hits.
  bool add(std::span<const Ray> rays, std::span<const std::uint32_t> masks) {
    const std::span<const QuerySpan> spans = passes_.trace_first_pass(rays, masks);
    later_.clear();
    std::size_t n_later = 0;
    const bool all = passes_.trace_further_passes(spans, true, [&](const Passes::More& more) {
      later_.push_back(more);
      n_later += more.n;
      return to_.t.size() + n_later <= at_once_;
    });
    if (!all) return false;
    // A ray's passes stay in their order.
    const auto by_ray = [](const Passes::More& a, const Passes::More& b) { return a.ray < b.ray; };
    if (!std::is_sorted(later_.begin(), later_.end(), by_ray))
      std::stable_sort(later_.begin(), later_.end(), by_ray);
    const std::size_t n = place(spans);
    if (n > 0) passes_.first_lists().pack(places_, n, as_refs_, chunk_);
    fill_in_later(spans);
    if (!as_refs_) name_places(passes_.target().scene.flat, {chunk_.instance, chunk_.instance ? n : 0});
    give_back();
    for (const std::uint32_t ray : passes_.in_doubt()) to_.in_doubt[n_rays_ + ray] = 1;
    n_rays_ += rays.size();
    return true;
  }

 private:
  // Makes space for the chunk's hits, and says where each ray's begin: how many there are.
  std::size_t place(std::span<const QuerySpan> spans) {
    const std::size_t first = to_.t.size();
    places_.resize(spans.size());
    std::size_t n = 0;
    auto later = later_.begin();
    for (std::uint32_t i = 0; i < spans.size(); ++i) {
      places_[i] = static_cast<std::uint32_t>(n);
      const std::uint32_t n_here = std::min(spans[i].n_hits, max_hits_);
      n += n_here;
      bool more = spans[i].more != 0 || n_here < spans[i].n_hits;
      for (; later != later_.end() && later->ray == i; ++later) {
        n += later->n;
        more = later->others;
      }
      if (n > std::numeric_limits<std::uint32_t>::max())
        throw Error(
            ErrorCode::out_of_memory,
            "some tens of thousands of rays have more than 2^32 hits; ask for fewer of each (max_hits)");
      to_.splits[n_rays_ + i + 1] = first + n;
      to_.more[n_rays_ + i] = more;
    }
    grow_to(first, first + n, spans.size());
    return n;
  }

  // For all hits that there will be, if the other chunks have as many.
  void grow_to(std::size_t first, std::size_t n, std::size_t n_rays) {
    const double all = 1.05 * static_cast<double>(n) * static_cast<double>(to_.more.size()) /
                       static_cast<double>(n_rays_ + n_rays);
    const auto grow = [&](auto& array) {
      if (array.capacity() < n) array.reserve(std::max(n, static_cast<std::size_t>(all)));
      array.resize(n);
      return array.data() + first;
    };
    chunk_ = {grow(to_.t), grow(to_.primitive), grow(to_.u), grow(to_.v),
              passes_.has_instances() ? grow(to_.instance) : nullptr};
  }

  // Behind the hits of the first pass, which have left space for them.
  void fill_in_later(std::span<const QuerySpan> spans) {
    std::uint32_t ray = 0;
    std::size_t at = 0;
    for (std::size_t k = 0; k < later_.size(); ++k) {
      const Passes::More& more = later_[k];
      if (k == 0 || more.ray != ray) at = places_[more.ray] + spans[more.ray].n_hits;
      ray = more.ray;
      more.hits->copy(more.first, more.n, chunk_, at);
      at += more.n;
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
  bool as_refs_;
  std::size_t at_once_;
  std::size_t n_rays_ = 0;             // before the chunk
  HitArrays chunk_{};                  // the chunk's in the answer
  std::vector<std::uint32_t> places_;  // of the chunk's rays
  std::vector<Passes::More> later_;
};

}  // namespace

bool all_hits(Passes& passes, std::span<const Ray> rays, const CollectOptions& options, LocalHits& all) {
  all.splits.resize(rays.size() + 1);
  all.splits[0] = 0;
  all.more.resize(rays.size());
  all.in_doubt.assign(rays.size(), 0);
  all.t.clear(), all.primitive.clear(), all.u.clear(), all.v.clear(), all.instance.clear();
  if (rays.empty()) return true;
  passes.begin(rays.size(), options);
  Collection collection(all, passes, options);
  for (std::size_t first = 0, n = 0; first < rays.size(); first += n) {
    n = passes.next_chunk(rays.size() - first);
    if (!collection.add(rays.subspan(first, n), masks_of(options, first, n))) return false;
  }
  return true;
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
        passes.trace_first_pass(rays.subspan(first, n), masks_of(options, first, n));
    for (std::size_t i = 0; i < n; ++i) counts[first + i] = std::min(spans[i].n_hits, options.max_hits);
    passes.trace_further_passes(spans, false, [&](const Passes::More& more) {
      counts[first + more.ray] += more.n;
      return true;
    });
    for (const std::uint32_t ray : passes.in_doubt()) counts[first + ray] = kInDoubtCount;
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
