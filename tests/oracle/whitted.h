// What    The oracle's shading: a recursive Whitted ray tracer, one ray at a time, as docs/scenes.md
//         states the model; it returns colours upward, where kdray carries weights downward.
// Source  T. Whitted, "An improved illumination model for shaded display", CACM 23(6), 1980; shadow
//         terminator: J. Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, 2021.
#pragma once

#include <cstdint>
#include <vector>

#include "oracle/primitives.h"

namespace kdray::oracle {

struct RayCounts {
  std::uint64_t primary = 0, primary_hit = 0, shadow = 0, reflected = 0, refracted = 0;
  std::uint64_t light_in_front = 0;  // shadow rays, and lights in front of a surface that add nothing to it
  RayCounts& operator+=(const RayCounts& other);
};

// Every discrete decision of a ray tree in order: primitives hit, state of each light, total reflections. Two
// rays of equal paths differ by smooth functions only.
using Path = std::vector<int>;

class Whitted {
 public:
  Whitted(const scene::Scene& scene, int depth) : scene_(scene), world_(scene), depth_(depth) {}

  dvec3 trace_eye(const Ray& ray, Path& path, RayCounts& counts) const;
  const World& world() const { return world_; }

 private:
  struct Tree;     // what goes along down one eye ray's tree
  struct Shading;  // a hit, its normals turned to the viewer
  dvec3 trace(const Ray& ray, int depth, Tree& tree) const;
  Shading prepare(const Ray& ray, const Hit& hit) const;
  dvec3 direct(const Shading& s, Tree& tree) const;
  dvec3 light(const Shading& s, const scene::Light& light, Tree& tree) const;
  dvec3 reflected(const Shading& s, const dvec3& share, int depth, Tree& tree) const;
  Ray spawn(const Shading& s, const dvec3& direction) const;

  const scene::Scene& scene_;
  World world_;
  int depth_;
};

}  // namespace kdray::oracle
