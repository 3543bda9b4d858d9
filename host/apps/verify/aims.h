// What    The rays of a round: origins, and what they are aimed at.
// Shape   From inside of watertight components: origins that are surely inside, found by moving in from
//         faces, each used for many rays at the component's vertices and edges, along the axes and all
//         around. From outside: from a sphere about the scene and from anywhere in it, at places of
//         primitives.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "apps/verify/inside.h"
#include "apps/verify/probes.h"
#include "apps/verify/random.h"

namespace kdray::verify {

inline constexpr std::int64_t kNowhere = -1;

struct Aimed {
  Ray ray;
  std::int64_t component = kNowhere;  // that it begins in
  std::int64_t target = kNowhere;     // kind by kind, in Geometry's order
};

struct InsideOrigin {
  vec3 point;
  std::uint32_t component;
};

class Aims {
 public:
  // `clearance` is how far origins keep from their component.
  Aims(const Subject& subject, const Insides& insides, double clearance, std::uint64_t seed);

  // Finds all origins inside, `n` at most, in parallel.
  std::vector<InsideOrigin> find_origins(std::size_t n);
  Aimed from_inside(const InsideOrigin& origin);
  Aimed from_outside();

 private:
  std::optional<InsideOrigin> move_in(std::uint32_t face) const;
  dvec3 place_on_triangle(std::size_t triangle, bool of_outline);
  dvec3 place_on(std::size_t target);

  const Subject& subject_;
  const Insides& insides_;
  const double clearance_;
  Random random_;
  std::vector<std::uint32_t> faces_;     // of watertight components that are large enough, group by group
  std::vector<std::size_t> first_of_;    // of each such group in faces_, and the end
  std::vector<std::uint32_t> group_of_;  // of each component
};

}  // namespace kdray::verify
