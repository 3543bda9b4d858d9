#include "io/image/queue_colors.h"

#include <algorithm>
#include <cmath>

namespace kdray::image {

namespace {

constexpr std::array<std::array<std::uint8_t, 3>, 7> kFirst = {{{230, 159, 0},
                                                                {86, 180, 233},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {240, 228, 66},
                                                                {0, 114, 178},
                                                                {213, 94, 0}}};

// A hue from 0 to 1, and how far its colours are from grey.
std::array<std::uint8_t, 3> of_hue(double hue, double chroma, double brightness) {
  std::array<std::uint8_t, 3> color{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double from_peak =
        std::abs(std::fmod(hue + static_cast<double>(k) / 3, 1.0) - 0.5) * 6;  // 0 at the channel's peak
    const double share = std::clamp(2 - from_peak, 0.0, 1.0);
    color[k] = static_cast<std::uint8_t>(std::lround(255 * brightness * (1 - chroma * (1 - share))));
  }
  return color;
}

}  // namespace

std::array<std::uint8_t, 3> queue_color(std::size_t queue) {
  if (queue < kFirst.size()) return kFirst[queue];
  // Steps of the golden section never come back to where they were, and neighbours are far apart.
  constexpr double kGoldenSection = 0.6180339887498949;
  const double number = static_cast<double>(queue - kFirst.size());
  return of_hue(std::fmod(number * kGoldenSection, 1.0), queue % 2 == 0 ? 0.55 : 0.85,
                queue % 3 == 0 ? 0.75 : 0.95);
}

}  // namespace kdray::image
