#include "odprt/develop.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <limits>

#include "layout/frame.layout.h"

namespace kdray::odprt {

namespace {

constexpr std::size_t kGrain = 1 << 15;  // pixels to a task

layout::i64 sum_of(std::span<const std::span<const layout::i64>> films, std::size_t i) {
  layout::i64 sum = films.front()[i];
  for (const auto& film : films.subspan(1))
    if (__builtin_add_overflow(sum, film[i], &sum))
      sum = film[i] < 0 ? std::numeric_limits<layout::i64>::min() : std::numeric_limits<layout::i64>::max();
  return sum;
}

}  // namespace

void develop(std::span<const std::span<const layout::i64>> films, int samples, std::span<vec3> pixels) {
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      for (int c = 0; c < 3; ++c)
        pixels[i][c] = static_cast<float>(
            static_cast<double>(sum_of(films, 3 * i + static_cast<std::size_t>(c))) * scale);
  });
}

void add_up(std::span<const std::span<const layout::i64>> films, std::span<layout::i64> sums) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sums.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) sums[i] = sum_of(films, i);
  });
}

}  // namespace kdray::odprt
