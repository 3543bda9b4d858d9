// What    Room in a vector for all that the rest of a text will bring, should it go on as it began.
// Shape   reserve() before each push_back(); the rate is measured from where the vector got its first
//         element. Memory that is reserved and not used is never touched, so that too much costs nothing.
// Why     Growing by doubling touches each element's memory twice and copies it: that took longer than
//         reading the numbers.
#pragma once

#include <algorithm>
#include <cstddef>

namespace kdray::scene {

class ReserveAhead {
 public:
  template <class Vector>
  void reserve(Vector& elements, std::size_t bytes_left) {
    const std::size_t n = elements.size();
    if (n < elements.capacity()) return;
    if (n == 0) first_ = bytes_left;
    // So few elements say little about the rest, and are cheap to copy.
    if (n < kFew || first_ <= bytes_left) return;
    const double bytes_each = static_cast<double>(first_ - bytes_left) / static_cast<double>(n);
    const auto more = static_cast<std::size_t>(kSpare * static_cast<double>(bytes_left) / bytes_each);
    elements.reserve(n + std::max(n, more));
  }

 private:
  static constexpr std::size_t kFew = 4096;
  static constexpr double kSpare = 1.05;
  std::size_t first_ = 0;  // bytes left at the first element
};

}  // namespace kdray::scene
