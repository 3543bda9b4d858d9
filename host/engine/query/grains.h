// What    Work over the elements of a chunk, in grains that threads take: a small chunk by the caller alone.
//         And where a call looks whether it has been cancelled.
// Errors  throw_if_cancelled: ErrorCode::cancelled. Only the thread that made the call may ask.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "base/error.h"
#include "kdray/cancel.h"

namespace kdray::query {

inline void throw_if_cancelled(const std::optional<Cancel>& cancel) {
  if (cancel && cancel->is_cancelled()) throw Error(ErrorCode::cancelled, "the query was cancelled");
}

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

// work(first, last) for parts of [0, n), where an element may take long: in smaller grains, and with a look
// for cancellation now and then.
template <class Work>
void for_each_slow_grain(std::size_t n, const std::optional<Cancel>& cancel, const Work& work) {
  constexpr std::size_t kGrain = 64, kLook = 4096;
  for (std::size_t first = 0; first < n; first += kLook) {
    throw_if_cancelled(cancel);
    const std::size_t last = std::min(n, first + kLook);
    tbb::parallel_for(std::size_t{0}, (last - first + kGrain - 1) / kGrain, [&](std::size_t grain) {
      work(first + grain * kGrain, std::min(last, first + (grain + 1) * kGrain));
    });
  }
}

}  // namespace kdray::query
