#include "engine/pdprt/tiles.h"

#include <numeric>

namespace kdray::pdprt {

namespace {

constexpr std::uint32_t kSmallest = 8;
constexpr std::uint64_t kTilesPerUnit = 64;  // at least
constexpr double kLargestPart = 0.02;        // of a unit's time, for one tile

bool enough_tiles(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t n_units) {
  const std::uint64_t columns = (width + side - 1) / side, rows = (height + side - 1) / side;
  return columns * rows >= kTilesPerUnit * n_units;
}

// Whether tiles of this side would be cheap enough, if cost were spread evenly over the costliest tile:
// halves of it can't cost less on average.
bool cheap_enough(const TileCost& cost, std::uint32_t side, std::uint32_t n_units) {
  const double part = static_cast<double>(side) * side / static_cast<double>(cost.tile_pixels);
  return cost.costliest * part * n_units <= kLargestPart * cost.total;
}

}  // namespace

std::uint32_t choose_tile_side(std::uint32_t width, std::uint32_t height, std::uint32_t n_units,
                               const std::optional<TileCost>& measured, std::uint32_t largest) {
  std::uint32_t side = largest;
  while (side > kSmallest && !(enough_tiles(width, height, side, n_units) &&
                               (!measured || cheap_enough(*measured, side, n_units))))
    side /= 2;
  return side;
}

std::size_t tiles_in_time(double interval, double elapsed, std::size_t n_done, std::size_t n_slices) {
  constexpr double kMost = 0x1p40;
  const double left = std::max(interval - elapsed, 0.0);
  const double n = elapsed > 0 ? std::min(static_cast<double>(n_done) / elapsed * left, kMost) : 0;
  return std::max(static_cast<std::size_t>(n), n_slices);
}

namespace {

// A queue takes from the bag one in so many of its share of what is left: the last to come find so little
// that none keeps the others waiting.
constexpr std::size_t kPartsPerQueue = 4;

std::vector<std::vector<layout::u32>> assign_shares(const std::vector<layout::u32>& curve, Division division,
                                                    std::size_t n_queues) {
  std::vector<std::vector<layout::u32>> shares(n_queues);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::size_t queue = division == Division::interleaved ? i % n_queues : i * n_queues / curve.size();
    shares[queue].push_back(curve[i]);
  }
  return shares;
}

void append(std::vector<layout::u32>& to, std::span<const layout::u32> from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Tiles::Tiles(std::vector<layout::u32> curve, Division division, std::size_t n_queues, bool by_the_piece)
    : taken_(n_queues),
      by_the_piece_(by_the_piece),
      n_undone_(curve.size()),
      n_queues_(n_queues),
      usual_(n_queues) {
  // Entries that were taken must not move: the device may still be reading them.
  for (auto& tiles : taken_) tiles.reserve(curve.size());
  if (division == Division::bag) {
    shares_.resize(n_queues);
    bag_ = std::move(curve);
  } else {
    shares_ = assign_shares(curve, division, n_queues);
  }
}

Tiles::Tiles(std::size_t n_queues, std::size_t capacity) : Tiles({}, Division::bag, n_queues) {
  bag_.reserve(capacity);
  for (auto& tiles : taken_) tiles.reserve(capacity);
  ended_ = false;
}

void Tiles::add(std::span<const layout::u32> entries, std::size_t elsewhere) {
  const std::lock_guard lock(mutex_);
  append(bag_, entries);
  n_undone_ += entries.size();
  elsewhere_ = elsewhere;
  changed_.notify_all();
}

void Tiles::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  elsewhere_ = 0;
  changed_.notify_all();
}

std::size_t Tiles::stock() const {
  const std::lock_guard lock(mutex_);
  return bag_.size() - next_;
}

bool Tiles::is_over() const {
  const std::lock_guard lock(mutex_);
  return all_done();
}

std::size_t Tiles::usual() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(usual_.begin(), usual_.end(), std::size_t{0});
}

std::span<const layout::u32> Tiles::take(std::size_t queue, const Wanted& wanted) {
  const std::lock_guard lock(mutex_);
  std::vector<layout::u32>& taken = taken_[queue];
  const std::size_t first = taken.size();
  if (std::vector<layout::u32>& share = shares_[queue]; !share.empty()) {
    const std::size_t wanted_now = wanted.most - std::min(wanted.most, wanted.ahead);
    const std::size_t n = by_the_piece_ ? std::min(share.size(), wanted_now) : share.size();
    append(taken, std::span(share).first(n));
    share.erase(share.begin(), share.begin() + static_cast<std::ptrdiff_t>(n));
  } else {
    const std::size_t rest = bag_.size() - next_;
    const std::size_t part = std::max((rest + elsewhere_) / (kPartsPerQueue * n_queues_), wanted.least);
    const std::size_t in_all = std::min(part, wanted.most);
    const std::size_t n = std::min(rest, in_all - std::min(in_all, wanted.ahead));
    append(taken, std::span(bag_).subspan(next_, n));
    next_ += n;
  }
  if (taken.size() > first) usual_[queue] = taken.size() - first;
  return std::span(taken).subspan(first);
}

void Tiles::done(std::size_t queue) {
  const std::lock_guard lock(mutex_);
  n_undone_ -= taken_[queue].size();
  taken_[queue].clear();
  if (all_done()) changed_.notify_all();
}

std::size_t Tiles::give_back(std::size_t queue) {
  const std::lock_guard lock(mutex_);
  const std::size_t n_taken = taken_[queue].size();
  append(bag_, taken_[queue]);
  append(bag_, shares_[queue]);
  taken_[queue].clear();
  shares_[queue].clear();
  changed_.notify_all();
  return n_taken;
}

bool Tiles::wait(std::size_t queue) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return left_ || all_done() || has_some(queue); });
  return !left_ && !all_done();
}

void Tiles::close() {
  const std::lock_guard lock(mutex_);
  const std::size_t before = left_over_.size();
  for (std::vector<layout::u32>& share : shares_) {
    append(left_over_, share);
    share.clear();
  }
  append(left_over_, std::span(bag_).subspan(next_));
  next_ = bag_.size();
  n_undone_ -= left_over_.size() - before;
  changed_.notify_all();
}

void Tiles::leave() {
  const std::lock_guard lock(mutex_);
  left_ = true;
  changed_.notify_all();
}

bool Tiles::left() const {
  const std::lock_guard lock(mutex_);
  return left_;
}

}  // namespace kdray::pdprt
