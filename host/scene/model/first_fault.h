// What    The first of many elements at which something is wrong, looked for in parallel.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

namespace kdray::scene {

// Calls work(i) for every i < n, in parallel; returns the least i for which it returned false, or n.
template <class Work>
std::size_t first_fault(std::size_t n, const Work& work) {
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  std::atomic<std::size_t> first{n};
  tbb::parallel_for(std::size_t{0}, (n + kGrain - 1) / kGrain, [&](std::size_t grain) {
    for (std::size_t i = grain * kGrain; i < std::min(n, (grain + 1) * kGrain); ++i) {
      if (work(i)) continue;
      std::size_t least = first.load();
      while (i < least && !first.compare_exchange_weak(least, i)) {
      }
      return;
    }
  });
  return first.load();
}

}  // namespace kdray::scene
