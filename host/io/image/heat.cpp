#include "io/image/heat.h"

#include <algorithm>
#include <array>

#include "io/image/transfer.h"

namespace kdray::image {

vec3 heat(double share) {
  // Display values at equal steps, interpolated linearly as the eye sees them.
  static constexpr std::array<std::array<double, 3>, 6> kStops = {{{0, 0, 0},
                                                                   {0.20, 0.06, 0.48},
                                                                   {0.60, 0.14, 0.52},
                                                                   {0.90, 0.32, 0.36},
                                                                   {0.99, 0.65, 0.35},
                                                                   {0.99, 0.99, 0.80}}};
  const double position = (share > 0 ? std::min(share, 1.0) : 0.0) * (kStops.size() - 1);
  const std::size_t below = std::min<std::size_t>(static_cast<std::size_t>(position), kStops.size() - 2);
  const double part = position - static_cast<double>(below);
  const Transfer srgb{};
  vec3 color;
  for (int c = 0; c < 3; ++c)
    color[c] =
        static_cast<float>(decode(srgb, kStops[below][c] + part * (kStops[below + 1][c] - kStops[below][c])));
  return color;
}

}  // namespace kdray::image
