#include "bench/accuracy/shown.h"

#include <algorithm>
#include <cmath>

#include "io/image/color.h"
#include "io/image/compare.h"

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

Reference make_reference(Renderer& renderer, int width, int height, int samples, Precision precision) {
  Reference r;
  const auto render = [&](int scale, int n) {
    const Picture picture = renderer.render({.width = scale * width,
                                             .height = scale * height,
                                             .depth = 16,
                                             .min_weight = 0,
                                             .samples = n,
                                             .precision = precision,
                                             .mode = Mode::pdprt});
    r.seconds += renderer.statistics().seconds.render;
    return shrunk(image_of(picture), scale);
  };
  const image::Image one = render(2, samples / 8), other = render(4, samples / 32);
  image::Image mean = one;
  for (std::size_t i = 0; i < mean.pixels.size(); ++i)
    mean.pixels[i] = 0.5f * (one.pixels[i] + other.pixels[i]);
  r.image = shown(std::move(mean));
  r.own_error = image::compare(shown(one), shown(other)).rmse / 2;
  return r;
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
