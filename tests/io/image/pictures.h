// What    Pictures made for tests.
#pragma once

#include <random>

#include "io/image/image.h"

namespace kdray::image {

inline Image flat(int width, int height, const vec3& color) {
  return {width, height, std::vector<vec3>(static_cast<std::size_t>(width * height), color)};
}

inline Image noise(int width, int height, unsigned seed, float low = 0, float high = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  Image image = flat(width, height, vec3(0));
  for (vec3& p : image.pixels) p = vec3(value(random), value(random), value(random));
  return image;
}

}  // namespace kdray::image
