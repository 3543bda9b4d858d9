// What    Work over the elements of a chunk, in grains that threads take: a small chunk by the caller alone.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace kdray::query {

// work(first, last) for grains of [0, n).
template <class Work>
void for_each_grain(std::size_t n, const Work& work) {
  constexpr std::size_t kGrain = 4096;
  if (n <= kGrain) return work(std::size_t{0}, n);
  tbb::parallel_for(std::size_t{0}, (n + kGrain - 1) / kGrain,
                    [&](std::size_t grain) { work(grain * kGrain, std::min(n, (grain + 1) * kGrain)); });
}

// work(i) for each i of [0, n), in grains.
template <class Work>
void for_each_index(std::size_t n, const Work& work) {
  for_each_grain(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

}  // namespace kdray::query
