#include "odprt/shares.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "math/vec.h"

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

// Where the ray enters the cell; infinity where it doesn't.
double entry(const layout::PartCell& cell, const dvec3& origin, const dvec3& direction, double t_min) {
  double enter = t_min, leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double a = (cell.lo[k] - origin[k]) / direction[k], b = (cell.hi[k] - origin[k]) / direction[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

// A tile's sampled rays, and the parts that they enter first, as kernels/odprt/route.clh finds them.
class Probe {
 public:
  Probe(const layout::Frame& frame, std::span<const layout::PartCell> directory)
      : frame_(frame), directory_(directory) {}

  // At (x, y) in pixels. KDRAY_NO_PART: none.
  std::uint32_t first_part(double x, double y) const {
    const dvec3 direction = vector(frame_.forward) +
                            (x * frame_.x_scale + frame_.x_offset) * vector(frame_.right) +
                            (y * frame_.y_scale + frame_.y_offset) * vector(frame_.up);
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t part = KDRAY_NO_PART;
    for (std::size_t i = 0; i < directory_.size(); ++i) {
      if (directory_[i].n_cells > 0) continue;  // bounds of the cells that follow
      const double t = entry(directory_[i], vector(frame_.eye), direction, frame_.hither);
      if (t < nearest) nearest = t, part = directory_[i].part;
    }
    return part;
  }

 private:
  static dvec3 vector(const float* v) { return {v[0], v[1], v[2]}; }

  const layout::Frame& frame_;
  std::span<const layout::PartCell> directory_;
};

constexpr int kProbes = 3;  // a side of a tile

// How many of a tile's rays begin with each queue.
std::vector<int> count_rays(layout::u32 tile, const layout::Frame& frame, const Probe& probe,
                            std::span<const std::size_t> owner, std::size_t n_queues) {
  std::vector<int> counts(n_queues);
  for (int i = 0; i < kProbes * kProbes; ++i) {
    const double x = (KDRAY_TILE_COLUMN(tile) + (i % kProbes + 0.5) / kProbes) * frame.tile_width;
    const double y = (KDRAY_TILE_ROW(tile) + (i / kProbes + 0.5) / kProbes) * frame.tile_height;
    const std::uint32_t part = probe.first_part(x, y);
    if (part != KDRAY_NO_PART) ++counts[owner[part]];
  }
  return counts;
}

}  // namespace

Shares::Shares(std::vector<Entries> of_queues, Entries anyones)
    : own_(std::move(of_queues)), anyones_(std::move(anyones)) {
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

std::size_t Shares::left() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(own_.begin(), own_.end(), anyones_.size(),
                         [](std::size_t n, const Entries& own) { return n + own.size(); });
}

Shares share_evenly(std::span<const layout::u32> list, std::size_t n_queues) {
  return {std::vector<Shares::Entries>(n_queues), scattered(list)};
}

Shares share_by_part(std::span<const layout::u32> tiles, std::size_t n_queues, const layout::Frame& frame,
                     std::span<const layout::PartCell> directory, std::span<const std::size_t> owner) {
  std::vector<Shares::Entries> own(n_queues);
  Shares::Entries anyones;
  const Probe probe(frame, directory);
  for (const layout::u32 tile : scattered(tiles)) {
    const std::vector<int> counts = count_rays(tile, frame, probe, owner, n_queues);
    const auto most = std::max_element(counts.begin(), counts.end());
    (*most > 0 ? own[static_cast<std::size_t>(most - counts.begin())] : anyones).push_back(tile);
  }
  return {std::move(own), std::move(anyones)};
}

}  // namespace kdray::odprt
