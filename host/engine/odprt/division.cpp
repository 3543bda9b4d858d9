#include "engine/odprt/division.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "engine/odprt/assign.h"

namespace kdray::odprt {

bool Division::replicates() const {
  return std::find(part_of.begin(), part_of.end(), kEveryPart) != part_of.end();
}

std::vector<std::uint32_t> Division::subtrees_of(std::uint32_t part) const {
  std::vector<std::uint32_t> subtrees;
  for (std::uint32_t i = 0; i < part_of.size(); ++i)
    if (part_of[i] == part || part_of[i] == kEveryPart) subtrees.push_back(i);
  return subtrees;
}

std::size_t largest_bytes(const Division& division) {
  std::size_t largest = 0;
  for (const Part& part : division.parts) largest = std::max(largest, part.geometry_bytes());
  return largest;
}

namespace {

// Chooses the subtrees that every part is to hold.
std::vector<bool> choose_replicated(const Cut& cut, std::span<const double> costs, const DivideOptions& o) {
  std::vector<std::uint64_t> bytes;
  std::vector<double> visits;
  double all_bytes = 0;
  for (std::size_t i = 0; i < cut.subtrees.size(); ++i) {
    bytes.push_back(cut.subtrees[i].bytes);
    // An instance is in one part alone: a shadow ray need not name the one that it leaves.
    visits.push_back(cut.subtrees[i].placed ? 0 : costs[i] / cut.subtrees[i].visit);
    all_bytes += static_cast<double>(bytes.back());
  }
  // n parts that share s of the whole hold s + (1 - s)/n each.
  const double most = o.n_parts > 1 ? o.replicated * o.n_parts / (o.n_parts - 1) : 0;
  return replicate(visits, bytes, static_cast<std::uint64_t>(most * all_bytes));
}

}  // namespace

std::vector<std::uint32_t> assign(const Cut& cut, std::span<const double> costs, const DivideOptions& o) {
  const std::vector<bool> everywhere = choose_replicated(cut, costs, o);
  std::vector<double> rest_costs;
  std::vector<std::uint64_t> rest_bytes;
  double all = 0, replicated = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const std::uint64_t bytes = cut.subtrees[i].bytes;
    all += static_cast<double>(bytes);
    if (everywhere[i]) {
      replicated += static_cast<double>(bytes);
    } else {
      rest_costs.push_back(costs[i]);
      rest_bytes.push_back(bytes);
    }
  }
  const double most = (1.0 / o.n_parts + o.spare) * all - replicated;
  const std::vector<std::uint32_t> assigned =
      assign_balanced(rest_costs, rest_bytes, o.n_parts, static_cast<std::uint64_t>(std::max(most, 0.0)));
  std::vector<std::uint32_t> part_of;
  for (std::size_t i = 0, next = 0; i < costs.size(); ++i)
    part_of.push_back(everywhere[i] ? kEveryPart : assigned[next++]);
  return part_of;
}

Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::span<const double> costs, const DivideOptions& options) {
  return divide(scene, form, cut, assign(cut, costs, options), options.n_parts);
}

Division divide(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                std::vector<std::uint32_t> part_of, std::uint32_t n_parts) {
  Division division;
  division.part_of = std::move(part_of);
  if (n_parts == 1) {  // nothing to take apart, and nowhere to go
    division.parts.push_back({scene, form, 0});
    return division;
  }
  division.directory = make_directory(form, cut, division.part_of);
  division.parts = make_parts(scene, form, cut, division.part_of, n_parts);
  return division;
}

namespace {

// Cells lie within each other, and are of the rank's own parts.
void check_cells(std::span<const layout::PartCell> cells, const RankTable& table, int from) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (table.rank_of(cells[i].part) != from || cells[i].n_below >= cells.size() - i)
      transport::throw_odd_message(from);
}

// The directories of all ranks, in their order.
std::vector<layout::PartCell> gather_directories(std::span<const layout::PartCell> own,
                                                 const RankTable& table, transport::Together& all) {
  std::vector<layout::PartCell> cells;
  const std::vector<transport::Bytes> of_ranks = all.gather(transport::bytes_of_list(own));
  for (std::size_t from = 0; from < of_ranks.size(); ++from) {
    const transport::Bytes& bytes = of_ranks[from];
    const std::size_t first = cells.size(), n = bytes.size() / sizeof(layout::PartCell);
    if (n * sizeof(layout::PartCell) != bytes.size()) transport::throw_odd_message(static_cast<int>(from));
    cells.resize(first + n);
    if (n > 0) std::memcpy(&cells[first], bytes.data(), bytes.size());
    check_cells(std::span(cells).subspan(first), table, static_cast<int>(from));
  }
  return cells;
}

}  // namespace

Division divide_partition(const flatten::FlatScene& scene, const flatten::WideForm& form, const Cut& cut,
                          std::span<const double> costs, const RankTable& table, transport::Together& all) {
  Division own = divide(scene, form, cut, costs, {static_cast<std::uint32_t>(table.n_own()), kSpare, 0});
  if (table.n_own() == 1) own.directory = make_directory(form, cut, own.part_of);
  const auto first = static_cast<std::uint32_t>(table.own_first());
  Division division;
  division.parts.resize(table.n_queues());
  std::ranges::move(own.parts, division.parts.begin() + first);
  division.part_of = std::move(own.part_of);
  for (std::uint32_t& part : division.part_of) part += first;
  for (layout::PartCell& cell : own.directory) cell.part += first;
  // Where there is one part, there is nowhere to go.
  if (table.n_queues() > 1) division.directory = gather_directories(own.directory, table, all);
  return division;
}

std::size_t subtrees_of_rank(std::size_t n_subtrees, const RankTable& table) {
  return std::max<std::size_t>(1, n_subtrees * table.n_own() / table.n_queues());
}

}  // namespace kdray::odprt
