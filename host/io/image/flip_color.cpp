// What    The colour spaces and the distance of FLIP (paper, sections 4.1.1 and 4.1.3).
#include <algorithm>
#include <cmath>

#include "io/image/flip.h"

namespace kdray::image::flip {
namespace {

// Linear sRGB to CIE XYZ: the primaries and the D65 white of IEC 61966-2-1, white being (1, 1, 1) in RGB.
// GLM's matrices are written column by column.
const dmat3 kToXyz(0.41239080, 0.21263901, 0.01933082,   // red
                   0.35758434, 0.71516868, 0.11919478,   // green
                   0.18048079, 0.07219232, 0.95053215);  // blue
const dmat3 kFromXyz = glm::inverse(kToXyz);
const dvec3 kWhite = kToXyz * dvec3(1);

double lab_curve(double t) {
  constexpr double kDelta = 6.0 / 29;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
}

}  // namespace

dvec3 ycxcz(const dvec3& linear_rgb) {
  const dvec3 p = kToXyz * linear_rgb / kWhite;
  return {116 * p.y - 16, 500 * (p.x - p.y), 200 * (p.y - p.z)};
}

dvec3 linear_rgb(const dvec3& ycxcz) {
  const double y = (ycxcz.x + 16) / 116;
  return kFromXyz * (dvec3(y + ycxcz.y / 500, y, y - ycxcz.z / 200) * kWhite);
}

dvec3 hunt_lab(const dvec3& linear_rgb) {
  const dvec3 p = kToXyz * linear_rgb / kWhite;
  const dvec3 f(lab_curve(p.x), lab_curve(p.y), lab_curve(p.z));
  const double lightness = 116 * f.y - 16;
  return {lightness, 0.01 * lightness * 500 * (f.x - f.y), 0.01 * lightness * 200 * (f.y - f.z)};
}

double hyab(const dvec3& a, const dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

double largest_color_distance() {
  static const double distance = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  return distance;
}

double redistribute(double distance) {
  constexpr double kKnee = 0.4, kKneeError = 0.95;  // p_c and p_t of the paper
  const double largest = largest_color_distance();
  const double knee = kKnee * largest;
  if (distance < knee) return kKneeError / knee * distance;
  return std::min(1.0, kKneeError + (distance - knee) / (largest - knee) * (1 - kKneeError));
}

}  // namespace kdray::image::flip
