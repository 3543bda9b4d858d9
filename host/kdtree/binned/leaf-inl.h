// What    A leaf, its references in ascending order: each goes to the place of its rank, which takes no
//         branch. A sort by comparisons guesses wrongly at every other one of the few that a leaf has.
#if defined(KDRAY_BINNED_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KDRAY_BINNED_LEAF_INL_H
#undef KDRAY_BINNED_LEAF_INL_H
#else
#define KDRAY_BINNED_LEAF_INL_H
#endif

#include <algorithm>
#include <array>

#include "hwy/highway.h"
#include "kdtree/fragment.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::size_t kMostRanked = 32;  // above that a sort does less

// A cell has no primitive twice, so that all ranks differ.
HWY_ATTR inline void write_ranked(std::span<const BoundedRef> refs, Ref* out) {
  const hn::CappedTag<Ref, 16> d;
  alignas(64) std::array<Ref, kMostRanked> values{}, ranks;
  for (std::size_t i = 0; i < refs.size(); ++i) values[i] = refs[i].ref;
  for (std::size_t p = 0; p < refs.size(); p += hn::Lanes(d)) {
    const auto value = hn::Load(d, &values[p]);
    auto rank = hn::Zero(d);
    for (std::size_t i = 0; i < refs.size(); ++i)
      rank = hn::IfThenElse(hn::Lt(hn::Set(d, values[i]), value), hn::Add(rank, hn::Set(d, 1)), rank);
    hn::Store(rank, d, &ranks[p]);
  }
  for (std::size_t i = 0; i < refs.size(); ++i) out[ranks[i]] = values[i];
}

HWY_ATTR inline Box append_ranked_leaf(std::span<const BoundedRef> refs, const Bounds& contents, int depth,
                                       Fragment& out) {
  const std::span<Ref> own = add_leaf(refs.size(), contents, depth, out);
  if (refs.size() <= kMostRanked) {
    write_ranked(refs, own.data());
  } else {
    write_sorted(refs, own);
  }
  return out.contents.back();
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
