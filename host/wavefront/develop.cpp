#include "wavefront/develop.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace kdray::wavefront {

namespace {

constexpr std::size_t kGrain = 1 << 15;  // pixels to a task: 1 MiB of sums and picture

}  // namespace

void develop(std::span<const layout::i64> sums, int samples, std::span<vec3> pixels) {
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
  const auto channel = [scale](layout::i64 sum) {
    return static_cast<float>(static_cast<double>(sum) * scale);
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      pixels[i] = {channel(sums[3 * i]), channel(sums[3 * i + 1]), channel(sums[3 * i + 2])};
  });
}

}  // namespace kdray::wavefront
