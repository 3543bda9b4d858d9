#include "scene/textures/derived_pictures.h"

#include <algorithm>
#include <cmath>

namespace kdray::scene {

namespace {

std::size_t n_texels(const Picture& p) {
  return std::size_t{p.width} * p.height;
}

const std::uint8_t* texel(const Picture& p, std::uint32_t x, std::uint32_t y) {
  return p.texels.data() + 4 * (std::size_t{y} * p.width + x);
}

bool has_alpha(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i)
    if (p.texels[4 * i + 3] != 255) return true;
  return false;
}

std::uint8_t byte_of_unit(double v) {
  return static_cast<std::uint8_t>(std::lround((v + 1) / 2 * 255));
}

}  // namespace

bool is_grey(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i) {
    const std::uint8_t* t = p.texels.data() + 4 * i;
    if (t[0] != t[1] || t[1] != t[2]) return false;
  }
  return true;
}

std::shared_ptr<const Picture> normals_of_heights(const Picture& heights, double strength) {
  Picture out = blank_picture(heights.name, heights.width, heights.height);
  std::uint8_t* to = out.texels.data();
  const std::uint32_t w = heights.width, h = heights.height;
  for (std::uint32_t y = 0; y < h; ++y)
    for (std::uint32_t x = 0; x < w; ++x) {
      const auto slope = [&](const std::uint8_t* before, const std::uint8_t* behind) {
        return strength * (int{*behind} - int{*before}) / (2 * 255.0);
      };
      const double across = slope(texel(heights, (x + w - 1) % w, y), texel(heights, (x + 1) % w, y));
      const double down = slope(texel(heights, x, (y + h - 1) % h), texel(heights, x, (y + 1) % h));
      const double length = std::sqrt(1 + across * across + down * down);
      // Green points up in the picture, against the way in which rows follow each other.
      for (const std::uint8_t byte : {byte_of_unit(-across / length), byte_of_unit(down / length),
                                      byte_of_unit(1 / length), std::uint8_t{255}})
        *to++ = byte;
    }
  return std::make_shared<const Picture>(std::move(out));
}

std::shared_ptr<const Picture> with_alpha(const Picture* colors, const Picture& alpha) {
  const Picture& base = colors ? *colors : alpha;
  Picture out = blank_picture(base.name, base.width, base.height);
  if (colors)
    std::copy(base.texels.begin(), base.texels.end(), out.texels.begin());
  else
    std::fill(out.texels.begin(), out.texels.end(), std::uint8_t{255});
  const std::size_t channel = has_alpha(alpha) ? 3 : 0;
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const auto nearest = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) {
        return static_cast<std::uint32_t>((2 * std::uint64_t{i} + 1) * of / (2 * std::uint64_t{n}));
      };
      out.texels[4 * (std::size_t{y} * out.width + x) + 3] =
          texel(alpha, nearest(x, out.width, alpha.width), nearest(y, out.height, alpha.height))[channel];
    }
  return std::make_shared<const Picture>(std::move(out));
}

bool is_cut_out(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i)
    if (p.texels[4 * i + 3] != 0 && p.texels[4 * i + 3] != 255) return false;
  return true;
}

}  // namespace kdray::scene
