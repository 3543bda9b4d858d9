#include "engine/query/geometry_table.h"

#include <algorithm>

namespace kdray::query {

void GeometryTable::add(GeometryId id, std::uint32_t n, std::uint32_t mask) {
  if (n == 0) return;
  geometries_.push_back({next_, n, id, mask});
  next_ += n;
}

void GeometryTable::add_instances(GeometryId id, std::uint32_t n, std::uint32_t mask) {
  if (n == 0) return;
  instances_.push_back({next_instance_, n, id, mask});
  next_instance_ += n;
}

const GeometryTable::Geometry& GeometryTable::holder(const std::vector<Geometry>& geometries,
                                                     std::uint32_t number) {
  if (geometries.size() == 1) return geometries.front();
  const auto after = std::upper_bound(geometries.begin(), geometries.end(), number,
                                      [](std::uint32_t n, const Geometry& g) { return n < g.first; });
  return *(after - 1);
}

std::uint32_t GeometryTable::copy_of(std::uint32_t number) const {
  const auto after = std::ranges::upper_bound(copies_.first, number);
  return static_cast<std::uint32_t>(after - copies_.first.begin() - 1);
}

GeometryTable::Place GeometryTable::of(std::uint32_t number, std::uint32_t instance) const {
  const bool is_copy = is_copied(number);
  if (is_copy) {
    instance = copy_of(number);
    number -= copies_.first[instance];
  }
  if (instance != kNoInstance) {
    const Geometry& g = holder(instances_, instance);
    return {g.id, number, instance - g.first, is_copy && copies_.is_mirrored[instance] != 0};
  }
  const Geometry& g = holder(geometries_, number);
  return {g.id, number - g.first};
}

std::optional<GeometryId> GeometryTable::only() const {
  return geometries_.size() == 1 && instances_.empty() ? std::optional(geometries_.front().id) : std::nullopt;
}

bool GeometryTable::has_every_bit() const {
  const auto has = [](const Geometry& g) { return g.mask == 0xffffffffu; };
  return std::ranges::all_of(geometries_, has) && std::ranges::all_of(instances_, has);
}

std::vector<std::uint32_t> GeometryTable::masks(std::span<const std::uint32_t> instances) const {
  if (has_every_bit()) return {};
  std::vector<std::uint32_t> masks;
  if (!instances.empty()) {
    masks.push_back(static_cast<std::uint32_t>(1 + instances.size()));
    for (const std::uint32_t instance : instances) masks.push_back(holder(instances_, instance).mask);
  }
  const std::size_t first = masks.size();
  masks.resize(first + (copies_.size() > 0 ? copies_.first.back() : next_));
  for (const Geometry& g : geometries_)
    std::fill_n(masks.begin() + static_cast<std::ptrdiff_t>(first + g.first), g.n, g.mask);
  for (std::uint32_t i = 0; i < copies_.size(); ++i)
    std::fill_n(masks.begin() + static_cast<std::ptrdiff_t>(first + copies_.first[i]),
                copies_.first[i + 1] - copies_.first[i], mask_of_instance(i));
  return masks;
}

}  // namespace kdray::query
