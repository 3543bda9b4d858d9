// What    Checks the config and the geometry, and hands the work to the binned or the exact builder.
// Errors  ErrorCode::usage for costs that make no sense, ::input for more primitives than a tree can name.

#include "accel/kdtree/build.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "accel/kdtree/binned/binned.h"
#include "accel/kdtree/exact/exact.h"
#include "kdray/error.h"

namespace kdray::kdtree {

namespace {

constexpr std::size_t kFineMesh = std::size_t{1} << 19;  // primitives
constexpr int kDepthLimit = 64;                          // the traversal's stack

constexpr std::size_t kMostPrimitives = std::size_t{1}
                                        << 29;  // references twice as many, which nodes can name

void check(const BuildConfig& c, const scene::Geometry& geometry) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  if (!positive(c.cost_intersect) || !(std::isfinite(c.cost_traverse) && c.cost_traverse >= 0) ||
      !(positive(c.empty_bonus) && c.empty_bonus <= 1) ||
      !(std::isfinite(c.group_traverse) && c.group_traverse >= 0 && c.group_each >= 0 && c.group_each <= 1))
    throw Error(ErrorCode::usage, "kd-tree: costs must be positive and the empty-space factor in (0, 1]");
  if (c.block < 1 || c.block > 64 || (c.block & (c.block - 1)) != 0)
    throw Error(ErrorCode::usage, "kd-tree: the block size must be a power of two from 1 to 64");
  if (geometry.size() > kMostPrimitives)
    throw Error(ErrorCode::input, "too many primitives for one tree: " + std::to_string(geometry.size()));
  primitives::for_each_kind([&](auto kind) {
    if (decltype(kind)::of(geometry).size() > KDRAY_REF_INDEX_MASK)
      throw Error(ErrorCode::input, std::string("too many ") + decltype(kind)::kNames + " for one tree");
  });
}

// Returns by how much Ct is multiplied where cells are divided into groups: groups save most of the tests
// that a plane would save, and need no second references to what it cuts. In meshes, planes divide no cells
// of up to kWorthAPlane triangles. Other kinds gain more from planes, and some that are dear to test (cones)
// gain most (docs/logbook/kdtree.md): their kFenceFactor says how much.
double grouped_factor(const scene::Geometry& geometry, const BuildConfig& config) {
  constexpr double kWorthAPlane = 128, kShapes = 6;
  if (!config.groups || config.small_cells) return 1;
  const double n = static_cast<double>(std::max<std::size_t>(geometry.size(), 1));
  const double triangles = static_cast<double>(geometry.triangles.size()) / n;
  double fences = 1;
  primitives::for_each_shape([&](auto kind) {
    const double share = static_cast<double>(decltype(kind)::of(geometry).size()) / n;
    fences += decltype(kind)::Geometry::kFenceFactor * share;
  });
  // A leaf of kWorthAPlane triangles costs Ci*kWorthAPlane/block.
  const double of_triangles = kWorthAPlane * 2 / config.block;
  return (of_triangles * triangles + kShapes * (1 - triangles)) / fences;
}

BuildConfig priced(BuildConfig config, const scene::Geometry& geometry) {
  config.cost_traverse *= traverse_factor(config.quality) * grouped_factor(geometry, config);
  return config;
}

template <class Primitives>
void add_refs(const Primitives& primitives, scene::PrimitiveKind kind, std::vector<BoundedRef>& refs) {
  const std::size_t first = refs.size();
  refs.resize(first + primitives.size());
  tbb::parallel_for(std::size_t{0}, primitives.size(), [&](std::size_t i) {
    const Bounds b = bounds_from(scene::bounds_of(primitives[i]));
    refs[first + i] = {b.lo, make_ref(kind, static_cast<std::uint32_t>(i)), b.hi};
  });
}

std::vector<BoundedRef> all_refs(const scene::Geometry& geometry) {
  std::vector<BoundedRef> refs;
  refs.reserve(geometry.size());
  primitives::for_each_kind(
      [&](auto kind) { add_refs(decltype(kind)::of(geometry), decltype(kind)::kKind, refs); });
  return refs;
}

}  // namespace

int depth_limit(const BuildConfig& config, std::size_t n) {
  const double automatic = 8 + 1.3 * std::log2(static_cast<double>(std::max<std::size_t>(n, 1)));
  return std::min(kDepthLimit, config.max_depth >= 0 ? config.max_depth : static_cast<int>(automatic));
}

double traverse_factor(Quality quality) {
  return quality == Quality::fast ? 2 : 1;
}

BuildConfig suited(BuildConfig config, std::size_t n_primitives) {
  const bool fine = n_primitives > kFineMesh;
  config.block = fine ? 8 : 4;
  config.groups = true;
  if (fine || config.quality == Quality::fast || config.small_cells) {
    config.group_traverse = 0.3;
    config.group_each = 0;
  }
  return config;
}

Tree build(const scene::Geometry& geometry, const BuildConfig& asked) {
  const std::size_t n = geometry.size();
  check(asked, geometry);
  const BuildConfig config = priced(asked, geometry);
  Tree tree;
  if (n == 0) {
    tree.nodes.push_back({});
    tree.contents.push_back({});
    return tree;
  }
  const int max_depth = depth_limit(config, n);
  Bounds bounds;
  std::unique_ptr<TopNode> top;
  if (config.quality == Quality::best) {
    std::vector<BoundedRef> refs = all_refs(geometry);
    bounds = hull_of(refs);
    top = build_exact(geometry, config, max_depth, std::move(refs), bounds);
  } else {
    top = binned::build_binned(geometry, config, max_depth, bounds);
  }
  tree = assemble(*top);
  tree.bounds = box_from(bounds);
  return tree;
}

}  // namespace kdray::kdtree
