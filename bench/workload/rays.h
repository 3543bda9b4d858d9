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

#include "bench/workload/surfaces.h"
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

// Pixels across and down of a square picture of up to so many.
int side_of(int rays);

// How a camera looks: unit vectors, and half of the picture's height at distance 1.
struct CameraBasis {
  explicit CameraBasis(const scene::Camera& camera);

  dvec3 forward, right, up;
  double half_height;
};

// Its direction is that of `along`, which may have any length; the interval is in multiples of it.
Ray make_ray(const dvec3& origin, const dvec3& along, double t_max, double t_min = 0);

// Where a ray has met a surface.
struct Meeting {
  Meeting(const Surfaces& surfaces, const Ray& ray, const Hit& hit);

  dvec3 position;
  dvec3 incoming;  // unit
  dvec3 normal;    // unit, on the side that the ray came from
};

// Finds the closest hits of rays, so that secondary ones can be made of them.
using Tracer = std::function<std::vector<Hit>(std::span<const Ray>)>;

// The classes of these names, in the order of class_names().
std::vector<RayClass> make_classes(const scene::Scene& scene, std::span<const std::string> names, int side,
                                   const Tracer& trace);

}  // namespace kdray::bench
