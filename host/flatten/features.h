// What    The feature mask of a scene and a render (kernels/layout/features.h says what each bit removes).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/geometry.h"
#include "scene/scene.h"

namespace kdray::flatten {

// What the scene needs, whatever the render's settings.
std::uint32_t features_of(const scene::Scene& scene, const scene::Geometry& geometry);

// What a render adds.
std::uint32_t features_of_samples(int samples, bool adaptive = false);

// A bit of the mask that a scene may do without.
struct Feature {
  std::uint32_t bit;
  const char* name;
};
std::span<const Feature> features();

struct FeatureNames {
  std::vector<std::string> on, off;
};
FeatureNames feature_names(std::uint32_t mask);

}  // namespace kdray::flatten
