#include "wavefront/film_sums.h"

namespace kdray::wavefront {

FilmSums::FilmSums(int width, int height)
    : width_(width),
      height_(height),
      sums_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {}

void FilmSums::add(std::size_t first_pixel, const std::vector<layout::i64>& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums_[first_pixel * 3 + i] += sums[i];
}

film::Image FilmSums::develop(int samples) const {
  film::Image image{width_, height_, std::vector<vec3>(sums_.size() / 3)};
  const double scale = 1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      image.pixels[i][k] =
          static_cast<float>(static_cast<double>(sums_[i * 3 + static_cast<std::size_t>(k)]) * scale);
  return image;
}

}  // namespace kdray::wavefront
