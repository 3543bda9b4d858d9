#include "engine/odprt/shares.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/vec.h"

namespace kdray::odprt {

namespace {

// Steps of the golden section, as far as they don't come to the same entry twice.
std::vector<layout::u32> scattered(std::span<const layout::u32> list) {
  auto step = static_cast<std::size_t>(0.6180339887 * static_cast<double>(list.size())) | 1u;
  while (std::gcd(step, list.size()) != 1) step += 2;
  std::vector<layout::u32> entries;
  for (std::size_t i = 0; i < list.size(); ++i) entries.push_back(list[i * step % list.size()]);
  return entries;
}

// Where a ray of the inverse direction enters the cell; infinity where it doesn't.
double entry(const layout::PartCell& cell, const dvec3& origin, const dvec3& inverse, double t_min) {
  double enter = t_min, leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double a = (cell.lo[k] - origin[k]) * inverse[k], b = (cell.hi[k] - origin[k]) * inverse[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

// A tile's sampled rays, and the parts that they enter first, as kernels/odprt/route.clh finds them.
class TileProbe {
 public:
  TileProbe(const layout::Frame& frame, std::span<const layout::PartCell> directory)
      : frame_(frame), directory_(directory), eye_(vector(frame.eye)) {}

  // At (x, y) in pixels of the whole picture. KDRAY_NO_PART: none.
  std::uint32_t first_part(double x, double y) const {
    const dvec3 across = (x * frame_.x_scale + frame_.x_offset) * vector(frame_.right) +
                         (y * frame_.y_scale + frame_.y_offset) * vector(frame_.up);
    const dvec3 origin = frame_.parallel ? eye_ + across : eye_;
    const dvec3 direction = frame_.parallel ? vector(frame_.forward) : vector(frame_.forward) + across;
    const dvec3 inverse = 1.0 / direction;
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t part = KDRAY_NO_PART;
    for (std::size_t i = 0; i < directory_.size(); ++i) {
      const layout::PartCell& cell = directory_[i];
      const double t = entry(cell, origin, inverse, frame_.hither);
      if (cell.n_below > 0) {
        if (t >= nearest) i += cell.n_below;
      } else if (t < nearest) {
        nearest = t, part = cell.part;
      }
    }
    return part;
  }

 private:
  static dvec3 vector(const float* v) { return {v[0], v[1], v[2]}; }

  const layout::Frame& frame_;
  std::span<const layout::PartCell> directory_;
  dvec3 eye_;
};

constexpr int kProbes = 3;  // a side of a tile

// The queue that most of a tile's rays begin with; n_queues: they meet no part.
std::size_t queue_of(layout::u32 tile, const layout::Frame& frame, const TileProbe& probe,
                     std::span<const std::size_t> owner, std::size_t n_queues) {
  std::vector<int> counts(n_queues);
  for (int i = 0; i < kProbes * kProbes; ++i) {
    const double x =
        frame.crop_x + (KDRAY_TILE_COLUMN(tile) + (i % kProbes + 0.5) / kProbes) * frame.tile_width;
    const double y =
        frame.crop_y + (KDRAY_TILE_ROW(tile) + (i / kProbes + 0.5) / kProbes) * frame.tile_height;
    const std::uint32_t part = probe.first_part(x, y);
    if (part != KDRAY_NO_PART) ++counts[owner[part]];
  }
  const auto most = std::max_element(counts.begin(), counts.end());
  return *most > 0 ? static_cast<std::size_t>(most - counts.begin()) : n_queues;
}

}  // namespace

Shares::Shares(Assignment assigned)
    : own_(std::move(assigned.of_queues)), anyones_(std::move(assigned.anyones)) {
  for (Entries& own : own_) std::reverse(own.begin(), own.end());
  std::reverse(anyones_.begin(), anyones_.end());
}

Shares::Entries& Shares::next_of(std::size_t queue) {
  if (!own_[queue].empty()) return own_[queue];
  if (!anyones_.empty()) return anyones_;
  return *std::max_element(own_.begin(), own_.end(),
                           [](const Entries& a, const Entries& b) { return a.size() < b.size(); });
}

Shares::Entries Shares::take(std::size_t queue, std::size_t n) {
  const std::lock_guard lock(mutex_);
  Entries taken;
  while (taken.size() < n) {
    Entries& from = next_of(queue);
    if (from.empty()) break;
    taken.push_back(from.back());
    from.pop_back();
  }
  return taken;
}

void Shares::add(Entries entries) {
  const std::lock_guard lock(mutex_);
  anyones_.insert(anyones_.end(), entries.rbegin(), entries.rend());
}

Shares::Entries Shares::give(std::size_t n) {
  const std::lock_guard lock(mutex_);
  Entries given;
  while (given.size() < n) {
    Entries& from = anyones_.empty() ? *std::ranges::max_element(own_, {}, &Entries::size) : anyones_;
    if (from.empty()) break;
    const std::size_t some = std::min(n - given.size(), (from.size() + 1) / 2);
    // The front is what would be taken last.
    const auto end = from.begin() + static_cast<std::ptrdiff_t>(some);
    given.insert(given.end(), from.begin(), end);
    from.erase(from.begin(), end);
  }
  std::ranges::reverse(given);
  return given;
}

Shares::Entries Shares::close() {
  const std::lock_guard lock(mutex_);
  Entries left = std::move(anyones_);
  anyones_.clear();
  for (Entries& own : own_) {
    left.insert(left.end(), own.begin(), own.end());
    own.clear();
  }
  return left;
}

std::size_t Shares::left() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(own_.begin(), own_.end(), anyones_.size(),
                         [](std::size_t n, const Entries& own) { return n + own.size(); });
}

Assignment share_evenly(std::span<const layout::u32> list, std::size_t n_queues) {
  return {std::vector<Shares::Entries>(n_queues), scattered(list)};
}

Assignment share_by_part(std::span<const layout::u32> tiles, std::size_t n_queues, const layout::Frame& frame,
                         std::span<const layout::PartCell> directory, std::span<const std::size_t> owner) {
  const TileProbe probe(frame, directory);
  const std::vector<layout::u32> order = scattered(tiles);
  std::vector<std::size_t> queues(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(),
                    [&](std::size_t i) { queues[i] = queue_of(order[i], frame, probe, owner, n_queues); });
  std::vector<Shares::Entries> shares(n_queues + 1);
  for (std::size_t i = 0; i < order.size(); ++i) shares[queues[i]].push_back(order[i]);
  Shares::Entries anyones = std::move(shares.back());
  shares.pop_back();
  return {std::move(shares), std::move(anyones)};
}

Assignment of_rank(const Assignment& all, const RankTable& table) {
  Assignment own;
  for (std::size_t q = 0; q < table.n_own(); ++q)
    own.of_queues.push_back(all.of_queues[table.own_first() + q]);
  const RankOf place = table.place();
  for (std::size_t i = place.rank; i < all.anyones.size(); i += place.ranks)
    own.anyones.push_back(all.anyones[i]);
  return own;
}

}  // namespace kdray::odprt
