// What    The background that rays see when they meet nothing, where it is not one colour: colours by height,
//         or a picture all around.
// Shape   A gradient's stops ascend; below the first and above the last their colours go on. A picture is
//         equirectangular: its top row lies at `up`, its bottom row opposite, its middle column forward, and
//         what is right of it lies to the right of a viewer looking that way. Pictures are shared, and never
//         changed.
// Units   Linear RGB; heights are sines of the angle above the horizon, from -1 to 1.
// Errors  A file is read with kdray::Error, ErrorCode::input, in one line: another format, a damaged file,
//         more texels than textures may have (picture.h), told by the header before much is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
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

// Returns the sky's axes. Without a turn, forward is -z as far as `up` allows: where kdray's cameras look by
// default.
SkyAxes axes_of(const Sky& sky);

double brightest_of(const Sky& sky);

// Returns what is wrong with a sky; nullptr where nothing is.
const char* fault_of(const Sky& sky);

// ---- The picture all around, from a file: EXR, Radiance HDR, PNG or, where kdray was built with
// libjpeg-turbo, JPEG; told by its first bytes. PNG and JPEG are codes of sRGB. What is no number, infinite
// or below 0 in an EXR counts as 0, with a warning.

std::shared_ptr<const SkyPicture> read_sky_picture(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings);
std::shared_ptr<const SkyPicture> decode_sky_picture(std::string_view bytes, const std::string& name,
                                                     std::vector<std::string>& warnings);

}  // namespace kdray::scene
