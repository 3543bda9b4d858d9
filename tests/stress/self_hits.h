// What    What the test of self-hits (self_hits_test.cpp) must know of each kind of primitive: hostile scenes
//         of it, places on one, and when a ray that leaves one may meet it again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kdray/kdray.h"
#include "scene/model/scene.h"
#include "stress/exact.h"
#include "stress/random.h"

namespace kdray::stress {

inline constexpr int kPrimitives = 96;  // of a scene

inline dvec3 point3(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

inline dvec3 tangent_to(const dvec3& n, Random& random) {
  for (;;) {
    const dvec3 t = glm::cross(n, random.direction());
    if (glm::length(t) > 1e-3) return glm::normalize(t);
  }
}

// A point of a surface, with its normal and how large things are about it.
struct Spot {
  dvec3 point, normal;
  double size;
};

// The scenes of a kind; `share` of all rays.
struct Family {
  const char* name;
  scene::Scene (*make)(std::uint64_t seed);
  double share;
};

enum class Verdict { right, wrong, excepted };

struct Departure {
  std::uint32_t primitive;  // that it leaves, by number
  bool inwards;             // to the inside of a sphere or cone
  bool to_light;
  float radius;  // of the surface where it leaves it
  float step;    // how far off the surface its origin was moved, about
  float blur;    // by how much at most in any direction
};

// Each kind has these (tests/primitives/<kind>.cpp): its scenes, kPrimitives of the kind each; a place on
// one; how thin the surface is about a point of it, for a departure's radius; and whether a hit of the
// surface that the ray has left may be.
#define KDRAY_SELF_HITS_OF_KIND(NAME, name, names, Struct)         \
  std::vector<Family> families_of(primitives::Struct##Kind);       \
  Spot spot_on(const layout::Struct& name, Random& random);        \
  float radius_at(const layout::Struct& name, const dvec3& point); \
  Verdict judge(const layout::Struct& name, const Ray& ray, const Hit& hit, const Departure& departure);
KDRAY_KINDS(KDRAY_SELF_HITS_OF_KIND)
#undef KDRAY_SELF_HITS_OF_KIND

// ---- What they are made of

inline scene::Scene with_material() {
  scene::Scene s;
  s.camera = scene::Camera{};
  s.materials.resize(1);
  s.materials[0].reflect = s.materials[0].transmit = vec3(0.5f);
  return s;
}

// A light that is nearer to the surface than rounding can tell is lit or not as rounding will have it.
template <class Surface>
bool ends_at_the_surface(const Surface& surface, const Ray& ray, const Departure& departure) {
  if (!departure.to_light) return false;
  Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  const double reach = glm::length(point3(ray.direction));
  const Exact3 end{Exact(o.x + d.x), Exact(o.y + d.y), Exact(o.z + d.z)};
  return std::abs(distance(end, surface)) <= 4 * departure.step + 0x1p-21 * reach;
}

// Of what is flat.
template <class Flat>
Verdict judge_flat(const Flat& surface, const Ray& ray, const Departure& departure) {
  return ends_at_the_surface(surface, ray, departure) ? Verdict::excepted : Verdict::wrong;
}
// Whether a point of the surface that is moved inwards by the step may come out again: on the other side, or
// across, where the blur is longer than half of the chord at that depth.
inline bool may_come_out_again(const Departure& d) {
  return 4 * d.step > d.radius || d.blur * d.blur > d.step * (2 * d.radius - d.step);
}

// From inside: the hit is what is behind the ray's way, not what it left. (Grazing, rounding moves it far;
// what was left lies behind the origin.)
template <class Curved>
bool is_on_the_way(const Exact3& o, const Exact3& d, const Curved& surface, float t_found) {
  return std::ranges::any_of(roots(o, d, surface), [t_found](const Exact& root) {
    const double t = root.get_d();
    return t > 0 && std::abs(t_found - t) <= 0.5 * t;
  });
}

// Of what has an inside. Where the exact hit lies just past an end (`is_at_an_end`), either is right.
template <class Curved>
Verdict judge_solid(const Curved& surface, const Ray& ray, const Hit& hit, const Departure& departure,
                    bool is_at_an_end) {
  if (ends_at_the_surface(surface, ray, departure)) return Verdict::excepted;
  const Exact3 o = exactly(ray.origin), d = exactly(ray.direction);
  // To the outside of a tip that is thinner than the blur, a normal may be so far off that even the exact ray
  // meets it again.
  if (!departure.inwards)
    return 4 * departure.step > departure.radius && is_on_the_way(o, d, surface, hit.t) ? Verdict::excepted
                                                                                        : Verdict::wrong;
  if (distance(o, surface) > 0) return may_come_out_again(departure) ? Verdict::excepted : Verdict::wrong;
  if (is_on_the_way(o, d, surface, hit.t)) return Verdict::right;
  if (is_at_an_end) return Verdict::excepted;
  return 64 * departure.step > departure.radius ? Verdict::excepted : Verdict::wrong;
}

}  // namespace kdray::stress
