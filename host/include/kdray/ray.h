// What    A ray and its hit, as users hand them over and get them back.
#pragma once

#include <cstdint>

namespace kdray {

struct Ray {
  float origin[3];
  float t_min;
  float direction[3];  // any length but 0; t counts in multiples of it
  float t_max;
};

struct Hit {
  float t;                 // inf: a miss; with any_hit 0: occluded
  std::int32_t primitive;  // number in file order; -1: a miss
  float u, v;  // triangle: barycentric weights of its 2nd and 3rd corner; cone: u = 0 base to 1 apex
};

}  // namespace kdray
