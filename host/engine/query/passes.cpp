#include "engine/query/passes.h"

#include <algorithm>

#include "base/error.h"
#include "engine/query/shared_rows.h"

namespace kdray::query {

using layout::QuerySpan;

namespace {

// Hits that there is space for in a launch: 8 MiB, which stay in a cache on their way to where they are
// packed; and more for a GPU, which wants a million rays at a time.
constexpr std::size_t kLaunchHits = std::size_t{1} << 19, kGpuLaunchHits = std::size_t{1} << 23;
// Of these a ray has space for so many in its first pass: more where more than one ray of sixteen had more.
constexpr std::uint32_t kLeastFirst = 8, kMostFirst = 64;
// The same in later passes, which take the rays that have more.
constexpr std::uint32_t kLeastLater = 64, kMostLater = 4096;

std::size_t launch_hits(const Target& target) {
  return target.global ? kGpuLaunchHits : kLaunchHits;
}

Traversal walk_for(const Target& target, Traversal asked) {
  if (target.precision != Precision::float32)
    throw Error(ErrorCode::usage,
                "all hits are found in float, and those of double rays that float leaves undecided in double "
                "anyway; leave the precision out");
  if (asked == Traversal::binary)
    throw Error(ErrorCode::usage,
                "all hits are found in the wide tree; ask for another traversal than binary");
  if (!target.scene.flat.instances.empty()) return Traversal::wide;  // the only one that follows them
  return asked == Traversal::automatic && target.global ? Traversal::wide : asked;
}

}  // namespace

void Hits::copy(std::size_t first, std::size_t n, const HitArrays& to, std::size_t at) const {
  const auto from = static_cast<std::ptrdiff_t>(first);
  std::copy_n(t.begin() + from, n, to.t + at);
  std::copy_n(primitive.begin() + from, n, to.primitive + at);
  std::copy_n(u.begin() + from, n, to.u + at);
  std::copy_n(v.begin() + from, n, to.v + at);
  if (to.instance) std::copy_n(instance.begin() + from, n, to.instance + at);
}

Passes::Passes(const Target& target, Traversal traversal)
    : target_(target),
      traversal_(walk_for(target, traversal)),
      masked_(target.masks() != nullptr),
      near_rays_(target.space_of_rays()),
      first_(target, {traversal_, masked_}, near_rays_.kernel_space()) {}

bool Passes::settle() noexcept {
  // What was kept of the last call's rays is not.
  rays_ = {};
  masks_ = {};
  cancel_.reset();
  const bool first = first_.settle(), later = !later_ || later_->settle();
  return first && later;
}

void Passes::begin(std::size_t n_rays, const CollectOptions& options) {
  faulty_miss_ = options.faulty_miss;
  as_refs_ = options.as_refs;
  cancel_ = options.cancel;
  max_hits_ = options.max_hits;
  capacity_ = std::clamp(options.max_hits, 1u, kLeastFirst);
  launch_capacity_ = std::min(n_rays * capacity_, launch_hits(target_));
  n_taken_ = 0;
}

std::size_t Passes::next_chunk(std::size_t left) const {
  return std::min(left, launch_capacity_ / capacity_);
}

std::span<const QuerySpan> Passes::trace_first_pass(std::span<const Ray> rays,
                                                    std::span<const std::uint32_t> masks) {
  throw_if_cancelled(cancel_);
  seen_ = look_at(rays);
  if (!faulty_miss_) refuse_faulty(rays, seen_, n_taken_);
  n_taken_ += rays.size();
  rays_ = rays;
  masks_ = masks;
  if (seen_.first_fault < seen_.n_rays) rays_ = kept_ = without_faulty(rays);
  const bool all_near = near_rays_.all_near(seen_.farthest);
  const std::span<const Ray> taken = near_rays_.take(all_near ? std::span<const Ray>() : rays_);
  if (!all_near) rays_ = taken;
  const std::span<const QuerySpan> spans = first_.find({rays_, masks_}, !seen_.ordinary, {}, capacity_);
  in_doubt_.clear();
  if (target_.filters)
    for (std::uint32_t i = 0; i < spans.size(); ++i)
      if (is_in_doubt(spans[i])) in_doubt_.push_back(i);
  const auto n_more =
      std::count_if(spans.begin(), spans.end(), [](const QuerySpan& s) { return s.more != 0; });
  const auto launch_capacity = static_cast<std::uint32_t>(launch_capacity_);
  if (static_cast<std::size_t>(n_more) > spans.size() / 16)
    capacity_ = std::max(capacity_, std::min({2 * capacity_, kMostFirst, max_hits_, launch_capacity}));
  return spans;
}

bool Passes::trace_further_passes(std::span<const QuerySpan> spans, bool want_hits, const Found& found) {
  later_hits_.clear();
  std::vector<Rest> rest;
  for (std::uint32_t i = 0; i < spans.size(); ++i)
    if (spans[i].more != 0 && spans[i].n_hits < max_hits_) rest.push_back({i, spans[i].n_hits, spans[i]});
  const std::size_t most = launch_hits(target_) / kLeastLater;
  while (!rest.empty()) {
    std::vector<Rest> still;
    for (std::size_t first = 0; first < rest.size(); first += most)
      if (!pass(std::span(rest).subspan(first, std::min(rest.size() - first, most)), want_hits, found, still))
        return false;
    rest.swap(still);
  }
  return true;
}

bool Passes::pass(std::span<const Rest> rest, bool want_hits, const Found& found, std::vector<Rest>& still) {
  throw_if_cancelled(cancel_);
  const std::size_t launch_capacity = launch_hits(target_);
  if (!later_)
    later_ =
        std::make_unique<HitLists>(target_, HitLists::Walk{traversal_, masked_}, near_rays_.kernel_space());
  const auto capacity = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(launch_capacity / rest.size(), kLeastLater, kMostLater));
  std::vector<Ray> rays;
  std::vector<std::uint32_t> masks;
  std::vector<QuerySpan> after;
  for (const Rest& r : rest) {
    rays.push_back(rays_[r.ray]);
    if (!masks_.empty()) masks.push_back(masks_[r.ray]);
    after.push_back(r.span);
  }
  const std::span<const QuerySpan> spans = later_->find({rays, masks}, !seen_.ordinary, after, capacity);
  const Hits* const hits = want_hits ? packed(spans) : nullptr;
  for (std::size_t k = 0, at = 0; k < rest.size(); at += spans[k++].n_hits) {
    if (target_.filters && is_in_doubt(spans[k])) in_doubt_.push_back(rest[k].ray);
    const std::uint32_t n = std::min(spans[k].n_hits, max_hits_ - rest[k].n_hits);
    if (!found({rest[k].ray, hits, at, n, spans[k].more != 0 || n < spans[k].n_hits})) return false;
    if (spans[k].more != 0 && rest[k].n_hits + n < max_hits_)
      still.push_back({rest[k].ray, rest[k].n_hits + n, spans[k]});
  }
  return true;
}

const Hits* Passes::packed(std::span<const QuerySpan> spans) {
  std::vector<std::uint32_t> places;
  std::uint32_t n = 0;
  for (const QuerySpan& s : spans) {
    places.push_back(n);
    n += s.n_hits;
  }
  Hits& hits = *later_hits_.emplace_back(std::make_unique<Hits>(n, has_instances()));
  if (n > 0) later_->pack(places, n, as_refs_, hits.arrays());
  return &hits;
}

}  // namespace kdray::query
