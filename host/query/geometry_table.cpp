#include "query/geometry_table.h"

#include <algorithm>

namespace kdray::query {

void GeometryTable::add(GeometryId id, std::uint32_t n, std::uint32_t mask) {
  if (n == 0) return;
  geometries_.push_back({next_, n, id, mask});
  next_ += n;
}

GeometryTable::Place GeometryTable::of(std::uint32_t number) const {
  if (geometries_.size() == 1) return {geometries_.front().id, number};
  const auto after = std::upper_bound(geometries_.begin(), geometries_.end(), number,
                                      [](std::uint32_t n, const Geometry& g) { return n < g.first; });
  const Geometry& g = *(after - 1);
  return {g.id, number - g.first};
}

std::optional<GeometryId> GeometryTable::only() const {
  return geometries_.size() == 1 ? std::optional(geometries_.front().id) : std::nullopt;
}

std::vector<std::uint32_t> GeometryTable::masks() const {
  if (std::all_of(geometries_.begin(), geometries_.end(),
                  [](const Geometry& g) { return g.mask == 0xffffffffu; }))
    return {};
  std::vector<std::uint32_t> masks(next_);
  for (const Geometry& g : geometries_) std::fill_n(masks.begin() + g.first, g.n, g.mask);
  return masks;
}

}  // namespace kdray::query
