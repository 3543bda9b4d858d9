#include "bench/race/compare_hits.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace kdray::bench {

namespace {

bool lie_apart(const Hit& a, const Hit& b) {
  if (std::isfinite(a.t) != std::isfinite(b.t)) return true;
  return std::isfinite(a.t) && std::abs(a.t - b.t) > 1e-4f * std::max(std::abs(a.t), std::abs(b.t));
}

bool differ(const Hit& a, const Hit& b) {
  return lie_apart(a, b) && (!std::isfinite(a.t) || !std::isfinite(b.t) || a.primitive != b.primitive);
}

template <class Differ>
std::size_t count(std::span<const Hit> a, std::span<const Hit> b, Differ&& differ) {
  std::size_t n = std::max(a.size(), b.size()) - std::min(a.size(), b.size());
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) n += differ(a[i], b[i]) ? 1 : 0;
  return n;
}

template <class Differ>
double share(std::span<const Hit> a, std::span<const Hit> b, Differ&& differ) {
  const std::size_t n = std::max(a.size(), b.size());
  return n == 0 ? 0 : static_cast<double>(count(a, b, differ)) / static_cast<double>(n);
}

}  // namespace

std::size_t count_not_identical(std::span<const Hit> a, std::span<const Hit> b) {
  return count(a, b, [](const Hit& x, const Hit& y) { return std::memcmp(&x, &y, sizeof(Hit)) != 0; });
}

double differing_share(std::span<const Hit> a, std::span<const Hit> b) {
  return share(a, b, differ);
}

double differing_distances(std::span<const Hit> a, std::span<const Hit> b) {
  return share(a, b, lie_apart);
}

}  // namespace kdray::bench
