#include "cluster/partition/scene_partition.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace kdray::partition {

namespace {

constexpr std::size_t kBins = 32;
constexpr int kMostLevels = 64;

struct Bin {
  std::uint64_t n = 0;
  Box bounds, middles;

  void add(const Bin& o) {
    n += o.n;
    bounds.grow(o.bounds);
    middles.grow(o.middles);
  }
};
using Bins = std::array<std::array<Bin, kBins>, 3>;  // along each axis

struct Node {
  Bin all;
  std::uint64_t first_number = 0, last_number = 0xffffffffu;

  bool is_point() const { return all.middles.lo == all.middles.hi; }
};

struct Item {
  Box bounds;
  vec3 middle;
  std::uint64_t number;
};

Item item_of(std::uint64_t number, const Box& bounds) {
  // -0 becomes 0, so that the least and the largest are the same whichever comes first.
  const Box plain{bounds.lo + 0.0f, bounds.hi + 0.0f};
  return {plain, plain.lo * 0.5f + plain.hi * 0.5f, number};
}

// Where a node is split: what lies below bin `plane` along `axis` goes to one side.
struct Split {
  int axis = 0;
  std::size_t plane = 0;
};

// Returns the item's bin along `axis`; in a node whose middles are one point, by its number.
std::size_t bin_of(const Node& node, int axis, const Item& item) {
  double lo = node.all.middles.lo[axis], hi = node.all.middles.hi[axis], at = item.middle[axis];
  if (node.is_point()) {
    lo = static_cast<double>(node.first_number), hi = static_cast<double>(node.last_number);
    at = static_cast<double>(item.number);
  }
  if (!(hi > lo)) return 0;
  return std::min(kBins - 1, static_cast<std::size_t>((at - lo) / (hi - lo) * kBins));
}

double half_area(const Box& b) {
  const dvec3 e(b.extent());
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

// A strict order, so that all ranks choose the same.
struct Offer {
  Split split;
  bool balanced = false;
  double cost = std::numeric_limits<double>::infinity();

  bool better_than(const Offer& o) const {
    return balanced != o.balanced ? balanced : cost < o.cost;  // of equal ones the first
  }
};

void offer_planes(const std::array<Bin, kBins>& bins, int axis, std::uint64_t n, std::optional<Offer>& best) {
  std::array<Bin, kBins> above;  // of all bins from there on
  Bin sum;
  for (std::size_t i = kBins; i-- > 0;) sum.add(bins[i]), above[i] = sum;
  Bin below;
  for (std::size_t plane = 1; plane < kBins; ++plane) {
    below.add(bins[plane - 1]);
    const std::uint64_t fewer = std::min(below.n, above[plane].n);
    if (fewer == 0) continue;
    Offer offer{.split = {axis, plane}, .balanced = 8 * fewer >= n};
    offer.cost = offer.balanced ? half_area(below.bounds) * static_cast<double>(below.n) +
                                      half_area(above[plane].bounds) * static_cast<double>(above[plane].n)
                                : -static_cast<double>(fewer);
    if (!best || offer.better_than(*best)) best = offer;
  }
}

class Divider {
 public:
  Divider(const PrimitiveSet& set, transport::Together& all) : set_(set), all_(all), cell_of_(set.size(), 0) {
    for_each_box(set_, [&](std::uint32_t number, const Box& bounds) {
      const Item item = item_of(number, bounds);
      root_.all.add({1, item.bounds, {item.middle, item.middle}});
    });
    root_.all = all_.join_values(root_.all, [](Bin& sum, const Bin& one) { sum.add(one); });
    if (root_.all.n > 0) nodes_ = {root_};
  }

  Cells divide(std::uint64_t n_cells) {
    most_ = std::max<std::uint64_t>(1, root_.all.n / std::max<std::uint64_t>(1, n_cells));
    for (int level = 0; level < kMostLevels; ++level)
      if (!split_level()) break;
    Cells cells{.cells = {}, .cell_of = std::move(cell_of_)};
    for (const Node& node : nodes_) cells.cells.push_back({node.all.n, node.all.bounds});
    return cells;
  }

 private:
  bool split_level() {
    places_.assign(nodes_.size(), kWhole);
    std::size_t n = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].all.n > most_) places_[i] = n++;
    if (n == 0) return false;
    count(n);
    return apply();
  }

  template <class Use>
  void for_each_item(const Use& use) {
    std::size_t i = 0;
    for_each_box(
        set_, [&](std::uint32_t number, const Box& bounds) { use(cell_of_[i++], item_of(number, bounds)); });
  }

  void count(std::size_t n) {
    bins_.assign(n, Bins{});
    for_each_item([&](std::uint32_t cell, const Item& item) {
      if (places_[cell] == kWhole) return;
      const Node& node = nodes_[cell];
      const int n_axes = node.is_point() ? 1 : 3;
      const Bin one{1, item.bounds, {item.middle, item.middle}};
      for (int axis = 0; axis < n_axes; ++axis)
        bins_[places_[cell]][static_cast<std::size_t>(axis)][bin_of(node, axis, item)].add(one);
    });
    all_.join_lists(std::span<Bins>(bins_), [](Bins& sum, const Bins& one) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t bin = 0; bin < kBins; ++bin) sum[axis][bin].add(one[axis][bin]);
    });
  }

  std::optional<Split> split_of(std::size_t i) const {
    if (places_[i] == kWhole) return std::nullopt;
    std::optional<Offer> best;
    for (int axis = 0; axis < 3; ++axis)
      offer_planes(bins_[places_[i]][static_cast<std::size_t>(axis)], axis, nodes_[i].all.n, best);
    if (!best) return std::nullopt;
    return best->split;
  }

  // The two sides of a node, from its bins.
  std::array<Node, 2> sides_of(std::size_t i, const Split& split) const {
    std::array<Node, 2> sides;
    for (std::size_t bin = 0; bin < kBins; ++bin)
      sides[bin < split.plane ? 0 : 1].all.add(bins_[places_[i]][static_cast<std::size_t>(split.axis)][bin]);
    for (Node& side : sides)
      side.first_number = nodes_[i].first_number, side.last_number = nodes_[i].last_number;
    if (!nodes_[i].is_point()) return sides;
    // Of the numbers in a bin, wherever it has been rounded to.
    const double lo = static_cast<double>(nodes_[i].first_number),
                 hi = static_cast<double>(nodes_[i].last_number);
    const double plane = lo + (hi - lo) * static_cast<double>(split.plane) / kBins;
    sides[0].last_number = static_cast<std::uint64_t>(plane) + 1;
    sides[1].first_number = static_cast<std::uint64_t>(plane) > 0 ? static_cast<std::uint64_t>(plane) - 1 : 0;
    return sides;
  }

  // False: nothing could be split.
  bool apply() {
    std::vector<Node> next;
    std::vector<std::optional<Split>> splits(nodes_.size());
    std::vector<std::uint32_t> first(nodes_.size());  // where a node, or its lower side, is then
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      first[i] = static_cast<std::uint32_t>(next.size());
      splits[i] = split_of(i);
      if (splits[i]) {
        for (const Node& side : sides_of(i, *splits[i])) next.push_back(side);
      } else {
        next.push_back(nodes_[i]);
      }
    }
    std::size_t item_number = 0;
    for_each_item([&](std::uint32_t cell, const Item& item) {
      const std::optional<Split>& split = splits[cell];
      const bool upper = split && bin_of(nodes_[cell], split->axis, item) >= split->plane;
      cell_of_[item_number++] = first[cell] + (upper ? 1 : 0);
    });
    const bool some = next.size() > nodes_.size();
    nodes_ = std::move(next);
    return some;
  }

  static constexpr std::size_t kWhole = ~std::size_t{0};

  const PrimitiveSet& set_;
  transport::Together& all_;
  std::vector<std::uint32_t> cell_of_;
  Node root_;
  std::vector<Node> nodes_;          // the leaves, in order
  std::vector<std::size_t> places_;  // of each, among those that are to be split; kWhole: it isn't
  std::vector<Bins> bins_;           // of these
  std::uint64_t most_ = 1;
};

}  // namespace

Cells divide_into_cells(const PrimitiveSet& set, std::uint64_t n_cells, transport::Together& all) {
  return Divider(set, all).divide(n_cells);
}

std::uint64_t cells_for(std::uint64_t n) {
  constexpr std::uint64_t kMost = 1024, kLeast = 64;  // cells; primitives to a cell
  return std::min(kMost, (n + kLeast - 1) / kLeast);
}

std::vector<std::uint32_t> assign_cells(const std::vector<Cell>& cells, int ranks) {
  std::uint64_t n = 0;
  for (const Cell& cell : cells) n += cell.n;
  std::vector<std::uint32_t> rank_of;
  std::uint64_t before = 0;
  for (const Cell& cell : cells) {
    // Where its middle is in the run of all.
    const auto middle = static_cast<unsigned __int128>(2 * before + cell.n);
    const auto rank = static_cast<std::uint64_t>(middle * static_cast<unsigned>(ranks) /
                                                 (2 * std::max<std::uint64_t>(n, 1)));
    rank_of.push_back(
        static_cast<std::uint32_t>(std::min<std::uint64_t>(rank, static_cast<std::uint64_t>(ranks) - 1)));
    before += cell.n;
  }
  return rank_of;
}

}  // namespace kdray::partition
