#include "accel/kdtree/exact/median_split.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

namespace kdray::kdtree {

namespace {

// The longest first; of equal ones the lower.
std::array<int, 3> axes_by_length(const Bounds& cell) {
  const auto length = [&](int k) { return static_cast<double>(cell.hi[k]) - cell.lo[k]; };
  std::array<int, 3> axes = {0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return length(a) > length(b); });
  return axes;
}

float middle(float lo, float hi) {
  return static_cast<float>(std::midpoint(static_cast<double>(lo), static_cast<double>(hi)));
}

float median_of_centers(std::span<const BoundedRef> refs, int axis) {
  std::vector<float> centers;
  centers.reserve(refs.size());
  for (const BoundedRef& r : refs) centers.push_back(middle(r.lo[axis], r.hi[axis]));
  const auto median = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
  std::nth_element(centers.begin(), median, centers.end());
  return *median;
}

bool cuts(const Bounds& cell, int axis, float s) {
  return cell.lo[axis] < s && s < cell.hi[axis];
}

// Whether any reference is on one side alone: otherwise a split only doubles them.
bool separates(std::span<const BoundedRef> refs, int axis, float s) {
  return std::any_of(refs.begin(), refs.end(),
                     [&](const BoundedRef& r) { return r.hi[axis] <= s || r.lo[axis] >= s; });
}

Split split_at(int axis, float position) {
  Split split;
  split.axis = axis;
  split.position = position;
  return split;
}

Split spatial_median(const Bounds& cell) {
  const int axis = axes_by_length(cell)[0];
  const float s = middle(cell.lo[axis], cell.hi[axis]);
  return cuts(cell, axis, s) ? split_at(axis, s) : Split{};
}

Split object_median(std::span<const BoundedRef> refs, const Bounds& cell) {
  for (const int axis : axes_by_length(cell))
    if (const float s = median_of_centers(refs, axis); cuts(cell, axis, s) && separates(refs, axis, s))
      return split_at(axis, s);
  return {};
}

}  // namespace

Split median_split(std::span<const BoundedRef> refs, const Bounds& cell, SplitRule rule) {
  if (refs.size() <= kMedianLeaf) return {};
  return rule == SplitRule::spatial_median ? spatial_median(cell) : object_median(refs, cell);
}

}  // namespace kdray::kdtree
