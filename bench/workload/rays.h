// What    The classes of rays that tracers are compared on, made once for a scene from its camera and its
//         first light.
// Shape   side x side pixels, a ray each, in Morton order (or line by line: "scanline"). Secondary rays begin
//         at what the primary rays hit, in the primary rays' order, moved off the surface by
//         `offset_of(scene)` along the normal: to the viewer's side, refracted ones to the other. They are
//         made in double and rounded at the end. A class of rays that the scene has none of (no light,
//         nothing in view) is empty.
// Why     Directions have unit length: kdray doesn't ask for it, but Embree's cones are wrong without.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kdray/kdray.h"
#include "scene/model/scene.h"

namespace kdray::bench {

struct RayClass {
  std::string name;
  bool any_hit = false;
  std::vector<Ray> rays;
};

// primary, scanline, shadow, mirror, refracted, diffuse, random.
std::span<const std::string_view> class_names();

// How far secondary rays begin from their surface: 2^-16 of the scene's size or distance from the origin.
double offset_of(const scene::Scene& scene);

// Finds the closest hits of rays, so that secondary ones can be made of them.
using Tracer = std::function<std::vector<Hit>(std::span<const Ray>)>;

// The classes of these names, in the order of class_names().
std::vector<RayClass> make_classes(const scene::Scene& scene, std::span<const std::string> names, int side,
                                   const Tracer& trace);

}  // namespace kdray::bench
