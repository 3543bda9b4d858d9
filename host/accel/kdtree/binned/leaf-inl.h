// What    Appends a leaf, its references in ascending order: each goes to the place of its rank, which takes
//         no branch. For the few that a leaf has, half of a sort's branches would be mispredicted.
#if defined(KDRAY_BINNED_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_LEAF_INL_H
#undef KDRAY_BINNED_LEAF_INL_H
#else
#define KDRAY_BINNED_LEAF_INL_H
#endif

#include <algorithm>
#include <array>

#include "accel/kdtree/fragment.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::size_t kMostRanked = 32;  // above that a sort does less

// Writes the values by rank; all ranks differ, since a cell has no primitive twice. Reads up to kMostRanked
// values.
template <class D>
HWY_ATTR inline void write_ranked(D d, const Ref* values, std::size_t n, Ref* out) {
  alignas(64) std::array<Ref, kMostRanked> ranks;
  for (std::size_t p = 0; p < n; p += hn::Lanes(d)) {
    const auto value = hn::Load(d, values + p);
    auto rank = hn::Zero(d);
    for (std::size_t i = 0; i < n; ++i)
      rank = hn::IfThenElse(hn::Lt(hn::Set(d, values[i]), value), hn::Add(rank, hn::Set(d, 1)), rank);
    hn::Store(rank, d, &ranks[p]);
  }
  for (std::size_t i = 0; i < n; ++i) out[ranks[i]] = values[i];
}

// Writes up to kMostRanked numbers in ascending order; `values` has space for as many.
HWY_ATTR inline void write_ascending(const Ref* values, std::size_t n, Ref* out) {
  if (n == 1) {
    out[0] = values[0];
  } else if (n == 2) {
    out[0] = std::min(values[0], values[1]);
    out[1] = std::max(values[0], values[1]);
  } else if (n <= 4) {
    write_ranked(hn::CappedTag<Ref, 4>(), values, n, out);
  } else {
    write_ranked(hn::CappedTag<Ref, 16>(), values, n, out);
  }
}

HWY_ATTR inline Box append_ranked_leaf(std::span<const BoundedRef> refs, const Bounds& contents, int depth,
                                       Fragment& out) {
  const std::span<Ref> own = add_leaf(refs.size(), contents, depth, out);
  if (refs.size() <= kMostRanked) {
    alignas(64) std::array<Ref, kMostRanked> values;
    for (std::size_t i = 0; i < refs.size(); ++i) values[i] = refs[i].ref;
    write_ascending(values.data(), refs.size(), own.data());
  } else {
    write_sorted(refs, own);
  }
  return out.contents.back();
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
