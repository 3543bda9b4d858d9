#include "accel/kdtree/exact/naive_split.h"

#include <set>

namespace kdray::test {

namespace {

using kdtree::BoundedRef;
using kdtree::Bounds;
using kdtree::BuildConfig;

long double area(const Bounds& b) {
  long double e[3];
  for (int k = 0; k < 3; ++k) e[k] = static_cast<long double>(b.hi[k]) - b.lo[k];
  return 2 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
}

}  // namespace

long double naive_tests(std::size_t n, const BuildConfig& config) {
  const auto block = static_cast<std::size_t>(config.block);
  long double blocks = 0;
  for (std::size_t tested = 0; tested < n; tested += block) ++blocks;
  return block == 1 ? blocks : blocks + static_cast<long double>(n) / 1000;
}

long double naive_cost(const std::vector<BoundedRef>& refs, const Bounds& cell, const BuildConfig& config,
                       int axis, float position, bool planar_below) {
  std::size_t n_below = 0, n_above = 0, n_planar = 0;
  for (const BoundedRef& r : refs) {
    const bool planar = r.lo[axis] == position && r.hi[axis] == position;
    n_planar += planar;
    n_below += r.lo[axis] < position || (planar && planar_below);
    n_above += r.hi[axis] > position || (planar && !planar_below);
  }
  constexpr long double kNever = std::numeric_limits<long double>::infinity();
  if (position < cell.lo[axis] || position > cell.hi[axis]) return kNever;
  // A plane on the boundary is allowed only to give what lies there a flat cell of its own.
  if (position == cell.lo[axis] && (n_planar == 0 || !planar_below)) return kNever;
  if (position == cell.hi[axis] && (n_planar == 0 || planar_below)) return kNever;
  Bounds below = cell, above = cell;
  below.hi[axis] = position;
  above.lo[axis] = position;
  const long double tests =
      (area(below) * naive_tests(n_below, config) + area(above) * naive_tests(n_above, config)) / area(cell);
  const long double cost = config.cost_traverse + config.cost_intersect * tests;
  return n_below == 0 || n_above == 0 ? config.empty_bonus * cost : cost;
}

NaiveSplit naive_split(const std::vector<BoundedRef>& refs, const Bounds& cell, const BuildConfig& config) {
  NaiveSplit best;
  for (int axis = 0; axis < 3; ++axis) {
    if (cell.lo[axis] == cell.hi[axis]) continue;
    std::set<float> planes;
    for (const BoundedRef& r : refs) planes.insert({r.lo[axis], r.hi[axis]});
    for (const float s : planes) {
      for (const bool planar_below : {true, false}) {
        const long double cost = naive_cost(refs, cell, config, axis, s, planar_below);
        if (cost < best.cost) best = {axis, s, planar_below, cost};
      }
    }
  }
  return best;
}

}  // namespace kdray::test
