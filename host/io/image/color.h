// What    Colours: transfer curves between linear values and PNG's integers, and the quantiser that applies
//         one exactly; a heat map; and a colour for each queue.
// Shape   Curves map [0, 1] to [0, 1] and grow strictly.
// Errors  kdray::Error, ErrorCode::usage: a gamma that is not a positive number.
// Source  IEC 61966-2-1 (sRGB): 12.92 v below 0.0031308, else 1.055 v^(1/2.4) - 0.055. The first seven
//         colours of queues are Okabe and Ito's ("Color Universal Design", 2008), which all eyes tell apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace kdray::image {

// How linear values become PNG's integers: sRGB's curve, or v^(1/gamma); 1 is linear.
struct Transfer {
  bool srgb = true;
  double gamma = 2.2;  // used when !srgb
};

double encode(const Transfer& transfer, double linear);   // linear -> display
double decode(const Transfer& transfer, double display);  // display -> linear
void check(const Transfer& transfer);

// Rounds encode(v) * maximum to nearest. It is built once per picture, and holds the linear value at which
// each code begins, so that a pixel costs a short search instead of a power, and the result does not depend
// on a float's rounding.
class Quantizer {
 public:
  Quantizer(const Transfer& transfer, std::uint32_t maximum);  // maximum: 255 or 65535

  // The result is clamped to [0, maximum]; NaN gives 0.
  std::uint32_t operator()(float linear) const;

 private:
  static constexpr std::uint32_t kBuckets = 4096;
  std::uint32_t maximum_;
  std::vector<float> begin_;                // begin_[k]: the smallest float that gives code k + 1
  std::vector<std::uint32_t> bucket_code_;  // the code of the value b / kBuckets, b = 0 .. kBuckets
};

// Returns the colour of a heat map: black, indigo, magenta, orange, light yellow, with brightness growing all
// the way, so that the order of values survives a grey print and colour blindness.
vec3 heat(double share);  // share in [0, 1], clamped; NaN is 0. Linear RGB.

// ---- A colour for each queue, by which pictures show which queue traced what.

// What channel "queue" says where it is not the number of a queue.
inline constexpr float kNoQueue = -1;     // nothing was hit, or the tile was not traced by this process
inline constexpr float kEveryQueue = -2;  // all of them hold what was hit

// Returns red, green and blue as sRGB has them, 0 to 255.
std::array<std::uint8_t, 3> queue_color(std::size_t queue);

// Colours as the web writes them: the names of CSS, "#rgb" and "#rrggbb". The text is sRGB, as on a screen;
// the result is linear. Source: CSS Color Module Level 4, "Named Colors".

// Small and large letters are the same. Returns nothing for any other text, "transparent" among it.
std::optional<vec3> css_color(std::string_view text);

// The names, for suggestions.
std::vector<std::string_view> css_names();

}  // namespace kdray::image
