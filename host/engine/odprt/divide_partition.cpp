#include "engine/odprt/divide_partition.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace kdray::odprt {

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
