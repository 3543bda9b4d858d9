#include "engine/query/nearby_order.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace kdray::query {

namespace {

constexpr int kBits = 7;  // of a cell's place along an axis
constexpr double kCells = 1 << kBits;

// The sort goes over the low and the high half of a cell's number.
constexpr int kHalf = (3 * kBits + 1) / 2;
constexpr std::size_t kBuckets = std::size_t{1} << kHalf;

// Each bit three places from the next.
std::uint32_t spread(std::uint32_t x) {
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

// Moves the indices into buckets by a half of their cells' numbers, in the order that they come in.
template <class IndexAt>
void sort_by_half(std::span<const std::uint32_t> cells, int shift, const IndexAt& index_at,
                  std::vector<std::uint32_t>& out) {
  std::array<std::uint32_t, kBuckets> next{};
  const auto bucket = [&](std::uint32_t index) { return cells[index] >> shift & (kBuckets - 1); };
  for (std::uint32_t i = 0; i < cells.size(); ++i) ++next[bucket(i)];
  std::uint32_t before = 0;
  for (std::uint32_t& n : next) n = std::exchange(before, before + n);
  out.resize(cells.size());
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t index = index_at(i);
    out[next[bucket(index)]++] = index;
  }
}

}  // namespace

NearbyOrder::NearbyOrder(const Box& box) : from_(box.lo) {
  const dvec3 extent = glm::max(dvec3(box.extent()), dvec3(std::numeric_limits<float>::min()));
  cells_per_length_ = kCells / extent;
}

std::uint32_t NearbyOrder::cell_of(const dvec3& place) const {
  const dvec3 at = glm::clamp((place - from_) * cells_per_length_, 0.0, kCells - 1);
  return spread(static_cast<std::uint32_t>(at.x)) | spread(static_cast<std::uint32_t>(at.y)) << 1 |
         spread(static_cast<std::uint32_t>(at.z)) << 2;
}

std::span<const std::uint32_t> NearbyOrder::sorted(std::span<const std::uint32_t> cells) {
  sort_by_half(
      cells, 0, [](std::uint32_t i) { return i; }, half_sorted_);
  sort_by_half(
      cells, kHalf, [this](std::uint32_t i) { return half_sorted_[i]; }, sorted_);
  return sorted_;
}

}  // namespace kdray::query
