// What    Work over rays or points on so many threads, for Embree: in grains, and with denormals flushed, as
//         Embree's manual asks of every thread that traces.
// Shape   A small number is the caller's own work. What a thread had of its own is as it was afterwards.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kdray::bench::embree {

class FlushedDenormals {
 public:
#if defined(__SSE__)
  FlushedDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | 0x8040);
  }
  ~FlushedDenormals() {
    _mm_setcsr(before_);
  }
#else
  FlushedDenormals() {}
  ~FlushedDenormals() {}
#endif
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

 private:
  unsigned before_ = 0;
};

class Workers {
 public:
  explicit Workers(int threads) : arena_(threads) {}

  static constexpr std::size_t kGrain = 1024, kAlone = 512;
  static std::size_t grains(std::size_t n) { return n <= kAlone ? 1 : (n + kGrain - 1) / kGrain; }

  // work(grain, first, end) for each grain of [0, n).
  template <class Work>
  void run(std::size_t n, const Work& work) {
    const auto flushed = [&](std::size_t grain, std::size_t first, std::size_t end) {
      const FlushedDenormals flush;
      work(grain, first, end);
    };
    if (grains(n) == 1) return flushed(0, 0, n);
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, grains(n), [&](std::size_t grain) {
        flushed(grain, grain * kGrain, std::min(n, (grain + 1) * kGrain));
      });
    });
  }

 private:
  tbb::task_arena arena_;
};

}  // namespace kdray::bench::embree
