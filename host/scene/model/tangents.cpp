#include "scene/model/tangents.h"

#include <cmath>

#include "base/local_space.h"

namespace kdray::scene {

namespace {

constexpr double kOffset = KDRAY_TANGENT_OFFSET;

double with_sign_of(double v, double sign) {
  return sign < 0 ? -v : v;
}

}  // namespace

std::array<float, 2> packed_tangent(const Tangent& tangent) {
  const dvec3& d = tangent.direction;
  const double size = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  if (!(size > 0) || !std::isfinite(size)) return {0, 0};
  double a = d.x / size, b = d.y / size;
  if (d.z < 0) {
    const double folded = with_sign_of(1 - std::abs(b), a);
    b = with_sign_of(1 - std::abs(a), b);
    a = folded;
  }
  return {static_cast<float>(a), static_cast<float>(with_sign_of(b + kOffset, tangent.hand))};
}

Tangent unpacked_tangent(const float* packed) {
  if (packed[1] == 0) return {};
  double a = packed[0], b = std::abs(double{packed[1]}) - kOffset;
  const double z = 1 - std::abs(a) - std::abs(b);
  if (z < 0) {
    const double folded = with_sign_of(1 - std::abs(b), a);
    b = with_sign_of(1 - std::abs(a), b);
    a = folded;
  }
  return {glm::normalize(dvec3(a, b, z)), packed[1] < 0 ? -1.0 : 1.0};
}

void move_tangents(const dmat3& linear, PageVector<layout::TexCoords>& tangents) {
  const double side = glm::determinant(linear) < 0 ? -1 : 1;
  for (layout::TexCoords& at : tangents)
    for (auto& corner : at.uv) {
      Tangent t = unpacked_tangent(corner);
      t = {safe_normalize(linear * t.direction), t.hand * side};
      const std::array<float, 2> packed = packed_tangent(t);
      corner[0] = packed[0], corner[1] = packed[1];
    }
}

}  // namespace kdray::scene
