#include "scene/primitives/exact.h"

#include <algorithm>
#include <cmath>

namespace kdray::primitives {

bool hits_again(const Quadratic& q, double t, bool outside) {
  if (!(q.a > 0)) return false;
  if (outside) return q.c < 0 || q.b > 0;
  if (q.c > 0) return true;
  const double root = std::sqrt(std::max(0.0, q.b * q.b - q.a * q.c));
  const double exit = q.b > 0 ? -q.c / (q.b + root) : (root - q.b) / q.a;
  return t < 0.5 * exit;
}

}  // namespace kdray::primitives
