// What    What rays that meet nothing see where that is not one colour: colours by height, or a picture all
//         around.
// Shape   A gradient's stops ascend; below the first and above the last their colours go on. A picture is
//         equirectangular: its top row lies at `up`, its bottom row opposite, its middle column forward, and
//         what is right of it on the right of who looks that way. Pictures are shared, and never changed.
// Units   Linear RGB; heights are sines of the angle above the horizon, from -1 to 1.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/vec.h"

namespace kdray::scene {

struct SkyStop {
  double height = 0;
  vec3 color{0};
  bool operator==(const SkyStop&) const = default;
};

struct SkyPicture {
  std::string name;  // in messages
  std::uint32_t width = 0, height = 0;
  std::vector<float> rgb;  // row by row from the top
  float brightest = 0;     // of its numbers
};

enum class SkyKind { none, gradient, picture };

struct Sky {
  SkyKind kind = SkyKind::none;  // none: the background's colour is all
  dvec3 up{0, 1, 0};             // of unit length
  double turn = 0;               // of a picture: about `up`, right-handed, in radians
  double strength = 1;           // of a picture: what it shows is multiplied by this
  std::vector<SkyStop> stops = {};
  std::shared_ptr<const SkyPicture> picture = {};  // gone once it is flattened
  double brightest = 0;                            // of all that it shows
};

struct SkyAxes {
  dvec3 right, up, forward;
};

// Without a turn, forward is -z as far as `up` allows: where kdray's cameras look by default.
SkyAxes axes_of(const Sky& sky);

double brightest_of(const Sky& sky);

// nullptr, or what is wrong with it.
const char* fault_of(const Sky& sky);

}  // namespace kdray::scene
