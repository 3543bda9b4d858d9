// What    What the picture tests do all the time: render a model, read the statistics, look for NaN.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "api/hooks.h"
#include "api/statistics_json.h"
#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "support/programs.h"

namespace kdray::test {

// Such a device for a new Renderer, as kept_programs() for a context.
inline DeviceOptions device_of(DeviceOptions options = {}) {
  options.programs = programs_folder();
  keep_programs(options);
  return options;
}

inline nlohmann::json statistics_of(const Renderer& renderer) {
  return api::statistics_json(renderer.statistics());
}

// Every ray that has any weight, to the given depth, one through each pixel: what an oracle can follow. (A
// min_weight of 0 asks for rays of no weight as well.)
inline RenderOptions exact_options(int width, int height, int depth = 5) {
  RenderOptions o;
  o.width = width;
  o.height = height;
  o.depth = depth;
  o.min_weight = 1e-9;
  o.samples = 1;
  return o;
}

inline bool all_finite(const Picture& picture) {
  for (const float v : picture.rgb)
    if (!std::isfinite(v)) return false;
  return true;
}

inline bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, [](float l, float r) {
    return std::bit_cast<std::uint32_t>(l) == std::bit_cast<std::uint32_t>(r);
  });
}

// The mean of Rec. 709 luminance, linear.
inline double mean_luminance(const Picture& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.rgb.size(); i += 3)
    sum += 0.2126 * p.rgb[i] + 0.7152 * p.rgb[i + 1] + 0.0722 * p.rgb[i + 2];
  return sum / (static_cast<double>(p.width) * p.height);
}

inline const std::vector<float>& channel(const Picture& p, const std::string& name) {
  for (const Channel& c : p.channels)
    if (c.name == name) return c.values;
  static const std::vector<float> none;
  ADD_FAILURE() << "no channel " << name;
  return none;
}

}  // namespace kdray::test
