// What    Rays through the user's scene, and what kdray did wrong with them: counts, and examples of such
//         rays.
// Shape   Rounds of rays: some from inside of watertight components, at their vertices, edges and all around;
//         some from outside and in between, at chosen places of all primitives; from each hit one that leaves
//         it on its own side (mirrored, diffuse or grazing) and one that goes straight on. All are traced by
//         every walk.
// Errors  What counts against kdray is certain: decided exactly, or by more than the proven bounds of its own
//         arithmetic. What can't be decided is counted as such. The same scene and number of rays give the
//         same report.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/verify/edges.h"
#include "apps/verify/mesh.h"
#include "kdray/kdray.h"
#include "scene/model/geometry.h"

namespace kdray::verify {

class Tracer;

enum class Defect {
  leak,          // a ray got out of a watertight component without a hit
  lost_hit,      // a ray missed what it was aimed at, and hit something behind it or nothing
  self_hit,      // a ray that left a primitive hit it again where it began
  behind,        // a hit that lies behind the ray's origin
  disagreement,  // a walk found another hit than the binary tree's
  not_a_number   // in a hit or in the origin of a ray that leaves one
};
inline constexpr std::size_t kDefects = 6;

struct Witness {
  Defect defect;
  vec3 where;                   // about the scene's centre
  std::int64_t primitive = -1;  // that was hit, or should have been
  Ray ray;                      // as kdray trace would take it, about the scene's centre
};

struct Probes {
  std::uint64_t from_inside = 0, from_outside = 0, leaving = 0;  // rays
  std::uint64_t origins = 0, components = 0;                     // inside of which rays began
  std::uint64_t in_doubt = 0;  // rays from inside that can't be judged with certainty
  // Rays that went straight on and entered, or left, a closed component twice in one place: at an edge a
  // ray's origin, moved off one face by its error bound, may come to lie before the other.
  std::uint64_t crossed_twice = 0;
  std::array<std::uint64_t, kDefects> count{};
  std::vector<Witness> witnesses;  // some of each defect

  std::uint64_t rays() const { return from_inside + from_outside + leaving; }
  std::uint64_t defects() const;
};

struct Subject {
  const scene::Scene& scene;
  const scene::Geometry& geometry;
  const Mesh& mesh;
  const Boxes& boxes;
  const Topology& topology;
};

Probes probe(const Subject& subject, Tracer& tracer, std::uint64_t n_rays,
             const std::function<void(double)>& progress = {});

}  // namespace kdray::verify
