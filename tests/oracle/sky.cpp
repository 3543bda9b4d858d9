#include "oracle/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kdray::oracle {

dvec3 gradient(const scene::Sky& sky, double height) {
  const auto& stops = sky.stops;
  if (height <= stops.front().height) return dvec3(stops.front().color);
  for (std::size_t i = 1; i < stops.size(); ++i) {
    if (height > stops[i].height) continue;
    const double share = (height - stops[i - 1].height) / (stops[i].height - stops[i - 1].height);
    return dvec3(stops[i - 1].color) * (1 - share) + dvec3(stops[i].color) * share;
  }
  return dvec3(stops.back().color);
}

namespace {

dvec3 texel(const scene::SkyPicture& p, std::int64_t x, std::int64_t y) {
  const std::int64_t w = p.width, h = p.height;
  x = ((x % w) + w) % w;
  y = std::clamp<std::int64_t>(y, 0, h - 1);
  const float* const rgb = &p.rgb[static_cast<std::size_t>(3 * (y * w + x))];
  return {rgb[0], rgb[1], rgb[2]};
}

// `v` turned about the axis by Rodrigues' formula.
dvec3 turned(const dvec3& v, const dvec3& axis, double angle) {
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
         axis * (glm::dot(axis, v) * (1 - std::cos(angle)));
}

}  // namespace

// The direction is turned back to where the sky stands upright, its middle at -z.
dvec3 sky_picture(const scene::Sky& sky, const dvec3& direction) {
  const dvec3 up = sky.up, level = dvec3(0, 0, -1) - up * glm::dot(dvec3(0, 0, -1), up);
  const dvec3 forward = turned(glm::normalize(level), up, sky.turn), right = glm::cross(forward, up);
  const double longitude = std::atan2(glm::dot(direction, right), glm::dot(direction, forward));
  const double latitude = std::asin(std::clamp(glm::dot(direction, up), -1.0, 1.0));
  const double x = (longitude / (2 * std::numbers::pi) + 0.5) * sky.picture->width - 0.5;
  const double y = (0.5 - latitude / std::numbers::pi) * sky.picture->height - 0.5;
  const auto i = static_cast<std::int64_t>(std::floor(x)), j = static_cast<std::int64_t>(std::floor(y));
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  const dvec3 above = texel(*sky.picture, i, j) * (1 - fx) + texel(*sky.picture, i + 1, j) * fx;
  const dvec3 below = texel(*sky.picture, i, j + 1) * (1 - fx) + texel(*sky.picture, i + 1, j + 1) * fx;
  return sky.strength * (above * (1 - fy) + below * fy);
}

}  // namespace kdray::oracle
