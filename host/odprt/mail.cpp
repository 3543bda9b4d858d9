#include "odprt/mail.h"

#include <algorithm>
#include <bit>

namespace kdray::odprt {

void Mail::put_rays(std::size_t slice, const float* stream, std::size_t capacity, std::size_t n_rays) {
  const float* const words = stream + KDRAY_RAY_FINDER * capacity;
  for (std::size_t i = 0; i < n_rays; ++i)
    deepest = std::max(deepest, std::bit_cast<std::uint32_t>(words[i]) >> 8);
  rays[slice].put(stream, capacity, n_rays);
  n += n_rays;
}

void Mail::put_pooled_rays(std::size_t slice, float* stream, std::size_t capacity, std::size_t n_rays,
                           std::uint32_t depth) {
  float* const words = stream + KDRAY_RAY_FINDER * capacity;
  for (std::size_t i = 0; i < n_rays; ++i)
    words[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(words[i]) | depth << 8);
  put_rays(slice, stream, capacity, n_rays);
}

void Mail::put_shadow_rays(std::size_t slice, const float* stream, std::size_t capacity, std::size_t n_rays) {
  shadow_rays[slice].put(stream, capacity, n_rays);
  n += n_rays;
}

void Mail::take_all(Mail& other) {
  for (std::size_t s = 0; s < rays.size(); ++s) {
    rays[s].take_all(other.rays[s]);
    shadow_rays[s].take_all(other.shadow_rays[s]);
  }
  n += other.n;
  deepest = std::max(deepest, other.deepest);
  other.n = 0;
  other.deepest = 0;
}

}  // namespace kdray::odprt
