// What    The rays of a round: origins, and what they are aimed at. They are chosen by random numbers that
//         are the same everywhere: the standard's engine with distributions of our own.
// Shape   Rays from inside of watertight components start at origins that are surely inside, found by moving
//         in from faces; each serves for many rays at the component's vertices and edges, along the axes and
//         all around. Rays from outside start on a sphere about the scene or anywhere in it, and go to places
//         of primitives.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "apps/verify/exact.h"
#include "apps/verify/probes.h"
#include "base/vec.h"

namespace kdray::verify {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  dvec3 direction() {
    const double z = between(-1, 1), angle = between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 engine_;
};

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
  // `clearance`: how far origins stay away from their component.
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
