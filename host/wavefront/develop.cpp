#include "wavefront/develop.h"

namespace kdray::wavefront {

void develop(std::span<const layout::i64> sums, int samples, std::span<vec3> pixels) {
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
  const auto channel = [scale](layout::i64 sum) {
    return static_cast<float>(static_cast<double>(sum) * scale);
  };
  for (std::size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = {channel(sums[3 * i]), channel(sums[3 * i + 1]), channel(sums[3 * i + 2])};
}

}  // namespace kdray::wavefront
