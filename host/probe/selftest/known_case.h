// What    The self-test's scene, its rays, and the hits that every device must find, bit for bit.
// Shape   A slanted quad behind a sphere and a cone, seen through a grid of rays; some hit each, some hit
//         nothing. The answers are those of the kernels as they are meant to be: tests/probe/selftest holds
//         them against closed forms in double.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kdray/ray.h"
#include "scene/model/scene.h"

namespace kdray::selftest {

scene::Scene known_scene();
std::vector<Ray> known_rays();

// A hit, its floats as bits.
struct Answer {
  std::uint32_t t;
  std::int32_t primitive;
  std::uint32_t u, v;
  bool operator==(const Answer&) const = default;
};

std::span<const Answer> known_answers();

}  // namespace kdray::selftest
