#include "bench/accuracy/shown.h"

#include <algorithm>
#include <cmath>

#include "io/image/color.h"

namespace kdray::bench {

namespace {

float shown_value(float v) {
  return v > 0 ? std::min(v, 1.0f) : 0;  // NaN is black, as in a PNG
}

}  // namespace

image::Image image_of(const Picture& picture) {
  image::Image image{picture.width, picture.height, {}};
  image.pixels.reserve(picture.rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < picture.rgb.size(); i += 3)
    image.pixels.emplace_back(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]);
  return image;
}

image::Image shown(image::Image image) {
  for (vec3& p : image.pixels) p = {shown_value(p.x), shown_value(p.y), shown_value(p.z)};
  return image;
}

image::Image shrunk(const image::Image& image, int factor) {
  image::Image small{image.width / factor, image.height / factor, {}};
  small.pixels.reserve(static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height));
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      dvec3 sum(0);
      for (int dy = 0; dy < factor; ++dy)
        for (int dx = 0; dx < factor; ++dx)
          sum += dvec3(
              image.pixels[static_cast<std::size_t>(y * factor + dy) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x * factor + dx)]);
      small.pixels.emplace_back(sum / static_cast<double>(factor * factor));
    }
  return small;
}

image::Image mean_of(image::Image a, const image::Image& b) {
  for (std::size_t i = 0; i < a.pixels.size(); ++i) a.pixels[i] = 0.5f * (a.pixels[i] + b.pixels[i]);
  return a;
}

image::Image error_picture(const image::Image& reference, const image::Image& image) {
  image::Image map{reference.width, reference.height, {}};
  map.pixels.reserve(reference.pixels.size());
  for (std::size_t i = 0; i < reference.pixels.size(); ++i) {
    float largest = 0;
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, std::abs(reference.pixels[i][c] - image.pixels[i][c]));
    map.pixels.push_back(image::heat(std::sqrt(largest)));
  }
  return map;
}

}  // namespace kdray::bench
