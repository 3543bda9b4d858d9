// What    The oracle of the split search: every bound of every reference on every axis, counted against all
//         references.
// Shape   O(N^2) and independent of the builder: its own counts and its own cost, in long double.
#pragma once

#include <limits>
#include <vector>

#include "accel/kdtree/build.h"
#include "accel/kdtree/reference.h"
#include "accel/kdtree/sah.h"

namespace kdray::test {

struct NaiveSplit {
  int axis = -1;
  float position = 0;
  bool planar_below = true;
  long double cost = std::numeric_limits<long double>::infinity();
};

// Tests that a leaf takes, in blocks of `block`: with blocks of several, a thousandth more for each
// reference.
long double naive_tests(std::size_t n, const kdtree::BuildConfig& config);

// The cost of one split; infinite where the plane doesn't cut the cell and nothing lies in it.
long double naive_cost(const std::vector<kdtree::BoundedRef>& refs, const kdtree::Bounds& cell,
                       const kdtree::BuildConfig& config, int axis, float position, bool planar_below);

NaiveSplit naive_split(const std::vector<kdtree::BoundedRef>& refs, const kdtree::Bounds& cell,
                       const kdtree::BuildConfig& config);

}  // namespace kdray::test
