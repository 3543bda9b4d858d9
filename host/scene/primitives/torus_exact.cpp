// What    What is certain about rays and tori, in double. The turns of the distance along a line are found as
//         the kernels find them (kernels/primitives/torus/turns.clh).

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/primitives/torus.h"

namespace kdray::primitives {

namespace {

constexpr int kHalvings = 60;

// h, the distance from the torus' circle, along a line.
class Along {
 public:
  Along(const Line& line, const TorusGeometry& t) : major_(t.major_radius) {
    const dvec3 axis = glm::normalize(dvec3(t.axis)), from = line.origin - dvec3(t.center);
    z_ = glm::dot(from, axis), dz_ = glm::dot(line.direction, axis);
    across_ = from - z_ * axis, moving_ = line.direction - dz_ * axis;
    square_ = glm::dot(line.direction, line.direction);
    const double size = 1.01 * (major_ + t.minor_radius), middle = -glm::dot(from, line.direction) / square_;
    const dvec3 nearest = from + middle * line.direction;
    const double half = std::sqrt(std::max(0.0, size * size - glm::dot(nearest, nearest)) / square_);
    lo_ = middle - half, hi_ = middle + half;
    find_turns();
  }

  double height(double t) const { return std::hypot(rho(t) - major_, z_ + t * dz_); }
  // Half of the slope of the square of the height.
  double slope(double t) const {
    const double away = rho(t), out = glm::dot(across_ + t * moving_, moving_);
    return (away > 0 ? (away - major_) * out / away : 0) + (z_ + t * dz_) * dz_;
  }

  // Where the line enters and leaves the sphere around the torus; the two valleys, and the hill between them.
  // A valley may lie at the hill, where there is but one.
  double lo() const { return lo_; }
  double hi() const { return hi_; }
  double left() const { return left_; }
  double hill() const { return hill_; }
  double right() const { return right_; }

  // Between lo and hi, on the way down (up: -1) or up, where it comes to `height`; lo or hi where it doesn't.
  double crossing(double lo, double hi, double up, double at) const {
    return halved(lo, hi, [&](double t) { return up * (height(t) - at) < 0; });
  }

 private:
  double rho(double t) const { return glm::length(across_ + t * moving_); }

  template <class Before>
  static double halved(double lo, double hi, const Before& before) {
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (lo + hi);
      (before(middle) ? lo : hi) = middle;
    }
    return 0.5 * (lo + hi);
  }

  void find_turns() {
    const double ee = glm::dot(moving_, moving_), nearest = -glm::dot(across_, moving_) / ee;
    const dvec3 c = across_ + nearest * moving_;
    const double cc = glm::dot(c, c), away = std::cbrt(major_ * cc * ee / square_);
    const double half = std::sqrt(std::max(0.0, away * away - cc) / ee), least = major_ * ee / square_;
    const bool whole = !(cc < least * least);  // convex all along
    const double first = whole ? hi_ : std::clamp(nearest - half, lo_, hi_);
    const double second = whole ? hi_ : std::clamp(nearest + half, lo_, hi_);
    const auto falls = [&](double t) { return slope(t) < 0; };
    left_ = halved(lo_, first, falls);
    hill_ = halved(first, second, [&](double t) { return slope(t) > 0; });
    right_ = halved(second, hi_, falls);
  }

  double major_, z_, dz_, square_;
  dvec3 across_, moving_;
  double lo_, hi_, left_, hill_, right_;
};

}  // namespace

dvec3 place_on(const TorusGeometry& t, double share, const dvec3& direction) {
  const dvec3 axis = glm::normalize(dvec3(t.axis)), across = direction - glm::dot(direction, axis) * axis;
  const double length = glm::length(across), angle = 2 * std::numbers::pi * share;
  const dvec3 out = length > 0 ? across / length : dvec3(0);
  const double major = t.major_radius, minor = t.minor_radius;
  return dvec3(t.center) + (major + minor * std::cos(angle)) * out + minor * std::sin(angle) * axis;
}

// Away from the nearest place of the circle.
dvec3 outward(const dvec3& point, const TorusGeometry& t) {
  const dvec3 axis = glm::normalize(dvec3(t.axis)), from = point - dvec3(t.center);
  const dvec3 across = from - glm::dot(from, axis) * axis;
  return from - static_cast<double>(t.major_radius) * safe_normalize(across);
}

// Through a valley well below the surface, near which the distance is off by more than the surface is.
std::optional<double> sure_target(const Line& line, const TorusGeometry& t, double margin) {
  const Along along(line, t);
  const double minor = t.minor_radius, deep = 0.99 * minor - margin, clear = 1.01 * minor + margin;
  const bool from_left = along.height(along.left()) < clear;
  const double valley = from_left ? along.left() : along.right();
  const double top = from_left ? along.lo() : along.hill();
  if (!(along.height(valley) < deep) || !(along.height(top) > clear) || !(top > 0)) return {};
  return along.crossing(top, valley, -1, minor);
}

// A ray that has left the torus may come back on its way down, or once it comes as near as rounding reaches
// behind a hill.
bool meets_again(const Line& line, const TorusGeometry& t, double at, const dvec3& side) {
  const Along along(line, t);
  const double minor = t.minor_radius, hill = along.hill();
  const bool outside = glm::dot(side, outward(line.origin, t)) > 0;
  if (outside != (along.height(0) > minor)) return true;
  if (outside) {
    if (along.slope(0) < 0) return false;
    const double clear = minor + 0x1p-17 * (t.major_radius + minor + glm::length(line.origin));
    if (!(hill > 0 && along.height(along.right()) < clear)) return true;
    return at < 0.5 * along.crossing(hill, along.right(), -1, clear);
  }
  const bool over_hill = hill > 0 && along.height(hill) > minor;
  const double exit = over_hill ? along.crossing(std::max(0.0, along.left()), hill, 1, minor)
                                : along.crossing(std::max(0.0, along.right()), along.hi(), 1, minor);
  return at < 0.5 * exit;
}

// Down through the surface before each valley that is below it, and up behind it. Where the line has one
// valley, the hill and the other lie at its end.
Crossings crossings(const Line& line, const layout::Torus& t) {
  const auto vector = [](const float(&v)[3]) { return vec3(v[0], v[1], v[2]); };
  const Along along(line, {vector(t.center), vector(t.axis), t.major_radius, t.minor_radius, 0});
  const double minor = t.minor_radius;
  const auto is_below = [&](double at) { return along.height(at) < minor; };
  Crossings found;
  if (!(along.lo() < along.hi())) return found;
  const double turns[] = {along.lo(), along.left(), along.hill(), along.right(), along.hi()};
  for (int i = 0; i < 4; ++i)
    if (is_below(turns[i]) != is_below(turns[i + 1]))
      found.add(along.crossing(turns[i], turns[i + 1], is_below(turns[i]) ? 1 : -1, minor));
  return found;
}

double distance_to(const layout::Torus& t, const dvec3& point) {
  const dvec3 axis = glm::normalize(dvec3(t.axis[0], t.axis[1], t.axis[2]));
  const dvec3 from = point - dvec3(t.center[0], t.center[1], t.center[2]);
  const double z = glm::dot(from, axis), out = glm::length(from - z * axis) - t.major_radius;
  return std::abs(std::hypot(out, z) - t.minor_radius);
}

}  // namespace kdray::primitives
