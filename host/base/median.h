// What    The median of some values: of an even number, the mean of the middle two.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace kdray {

// There must be one value at least.
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace kdray
