#include "accel/kdtree/binned/binned.h"

#include "base/highway_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/kdtree/binned/simd.cpp"
// First, as it includes this file for each instruction set.
#include "hwy/foreach_target.h"

#include "accel/kdtree/binned/subtree-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace kdray::kdtree::binned::HWY_NAMESPACE {

HWY_ATTR void Count(std::span<const BoundedRef> refs, const BinGrid& grid, std::size_t stride,
                    BinCounts& counts) {
  count_bins(refs, grid, stride, counts);
}

HWY_ATTR Plane BestPlane(const BinCounts& counts, const BinGrid& grid, const Bounds& contents, std::size_t n,
                         const BuildConfig& config) {
  return cheaper_than_leaf(best_between_bins(counts, grid, contents, n, config), n, config);
}

HWY_ATTR std::size_t NStraddling(std::span<const BoundedRef> refs, const Plane& plane) {
  return count_straddling(refs, plane);
}

HWY_ATTR Divided Divide(const scene::Geometry& geometry, const BuildConfig& config,
                        std::span<BoundedRef> refs, const Plane& plane, Workspace& workspace) {
  std::vector<BoundedRef>&straddlers = workspace.straddlers, &above = workspace.above;
  for (std::vector<BoundedRef>* const v : {&straddlers, &above})
    if (v->size() < refs.size() + 1) v->resize(refs.size() + 1);
  const Sorted sorted =
      sort_sides(refs.data(), refs.size(), plane, refs.data(), above.data(), straddlers.data());
  Divided sides{sorted.n_below, sorted.n_above};
  clip_straddling(geometry, config, {straddlers.data(), sorted.n_straddling}, plane, refs.data(),
                  above.data(), sides);
  return sides;
}

HWY_ATTR Bounds Hull(std::span<const BoundedRef> refs) {
  return hull_of_refs(refs);
}

HWY_ATTR void AppendGroups(std::span<BoundedRef> refs, const Bounds& contents, int depth,
                           const BuildConfig& config, Fragment& out) {
  std::vector<BoundedRef> scratch;
  SweepBuffers sweep;
  Grouper(config, depth, scratch, sweep, out).append(refs, contents);
}

HWY_ATTR void BuildSubtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth,
                           std::size_t n, const Cell& cell, Workspace& workspace) {
  workspace.fragment.clear();
  SubtreeBuilder(geometry, config, max_depth, workspace).build(0, n, cell);
}

}  // namespace kdray::kdtree::binned::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kdray::kdtree::binned {

HWY_EXPORT(Count);
HWY_EXPORT(BestPlane);
HWY_EXPORT(NStraddling);
HWY_EXPORT(Divide);
HWY_EXPORT(Hull);
HWY_EXPORT(AppendGroups);
HWY_EXPORT(BuildSubtree);

void count(std::span<const BoundedRef> refs, const BinGrid& grid, std::size_t stride, BinCounts& counts) {
  HWY_DYNAMIC_DISPATCH(Count)(refs, grid, stride, counts);
}
Plane best_plane(const BinCounts& counts, const BinGrid& grid, const Bounds& contents, std::size_t n,
                 const BuildConfig& config) {
  return HWY_DYNAMIC_DISPATCH(BestPlane)(counts, grid, contents, n, config);
}
std::size_t n_straddling(std::span<const BoundedRef> refs, const Plane& plane) {
  return HWY_DYNAMIC_DISPATCH(NStraddling)(refs, plane);
}
Divided divide(const scene::Geometry& geometry, const BuildConfig& config, std::span<BoundedRef> refs,
               const Plane& plane, Workspace& workspace) {
  return HWY_DYNAMIC_DISPATCH(Divide)(geometry, config, refs, plane, workspace);
}
Bounds fast_hull_of(std::span<const BoundedRef> refs) {
  return HWY_DYNAMIC_DISPATCH(Hull)(refs);
}
void append_groups(std::span<BoundedRef> refs, const Bounds& contents, int depth, const BuildConfig& config,
                   Fragment& out) {
  HWY_DYNAMIC_DISPATCH(AppendGroups)(refs, contents, depth, config, out);
}
void build_subtree(const scene::Geometry& geometry, const BuildConfig& config, int max_depth, std::size_t n,
                   const Cell& cell, Workspace& workspace) {
  HWY_DYNAMIC_DISPATCH(BuildSubtree)(geometry, config, max_depth, n, cell, workspace);
}

}  // namespace kdray::kdtree::binned
#endif
