// What    The feature mask of a scene and a render (kernels/layout/features.h says what each bit removes).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "layout/features.h"
#include "scene/model/geometry.h"
#include "scene/model/scene.h"

namespace kdray::flatten {

using layout::Features;

// Returns what the scene needs, whatever the render's settings.
Features features_of(const scene::Scene& scene, const scene::Geometry& geometry);

// Return what a mesh of the scene needs besides, and what its instances need.
Features features_of_mesh(const scene::Scene& scene, const scene::Scene& mesh,
                          const scene::Geometry& geometry);
Features features_of_instances(const scene::Scene& scene);

// Returns the mask for a scene that has the background and the lights of `scene` instead.
Features features_in_light(Features mask, const scene::Scene& scene);

// Returns what a render adds.
Features features_of_samples(int samples, bool adaptive = false);

// A bit of the mask that a scene may do without.
struct Feature {
  Features bit;
  const char* name;
};
std::span<const Feature> features();

struct FeatureNames {
  std::vector<std::string> on, off;
};
FeatureNames feature_names(Features mask);

}  // namespace kdray::flatten
