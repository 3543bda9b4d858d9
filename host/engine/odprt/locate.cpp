#include "engine/odprt/locate.h"

#include <limits>

namespace kdray::odprt {

namespace {

float distance_to(const Box& box, const vec3& point) {
  float sum = 0;
  for (int k = 0; k < 3; ++k) {
    const float outside = std::max({box.lo[k] - point[k], point[k] - box.hi[k], 0.0f});
    sum += outside * outside;
  }
  return sum;
}

}  // namespace

// What lies in a child's bounds is nowhere nearer than these are.
void Locator::look_below(std::size_t opened, const vec3& point, Nearest& nearest) const {
  const OpenedNode& node = cut_.top[opened];
  for (std::uint32_t slot = 0; slot < 8 && nearest.distance > 0; ++slot) {
    const std::int32_t below = node.below[slot];
    if (below == OpenedNode::kEmpty) continue;
    const float distance = distance_to(bounds_of_child(form_.nodes[node.node], slot), point);
    if (distance >= nearest.distance) continue;
    if (below >= 0)
      look_below(static_cast<std::size_t>(below), point, nearest);
    else
      nearest = {distance, static_cast<std::uint32_t>(-1 - below)};
  }
}

std::optional<std::uint32_t> Locator::find(const vec3& point) const {
  Nearest nearest{std::numeric_limits<float>::infinity()};
  if (!cut_.top.empty()) look_below(0, point, nearest);
  return nearest.subtree;
}

}  // namespace kdray::odprt
