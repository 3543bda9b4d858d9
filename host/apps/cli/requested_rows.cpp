#include "apps/cli/requested_rows.h"

#include "apps/cli/memory.h"

namespace kdray::cli {

namespace {

// Of the answer to one ray or point; of all hits for two of them, and what room for more is held meanwhile.
std::uint64_t answer_bytes(Question question) {
  switch (question) {
    case Question::closest:
      return 20;
    case Question::any:
      return 21;
    case Question::all:
      return 160;
    case Question::count:
      return 4;
    case Question::closest_point:
      return 48;
    case Question::signed_distance:
      return 8;
    case Question::inside:
      return 1;
  }
  return 0;
}

}  // namespace

RequestedRows::RequestedRows(array::RowsFile& file, const TraceRequest& request, std::uint64_t free) {
  const bool of_points = is_of_points(request.question);
  const bool traced = !of_points && !file.in_double() && request.question <= Question::any;
  if (traced)
    check_rays_fit(file.size(), free);
  else
    check_rows_fit(request.wanted().name, file.size(), file.row_bytes() + answer_bytes(request.question),
                   free);
  if (of_points && file.in_double())
    rows_ = file.read<std::array<double, 3>>();
  else if (of_points)
    rows_ = file.read<std::array<float, 3>>();
  else if (file.in_double())
    rows_ = file.read<std::array<double, 8>>();
  else
    rows_ = file.read<Ray>();
}

std::size_t RequestedRows::size() const {
  return std::visit([](const auto& rows) { return rows.size(); }, rows_);
}

Rays RequestedRows::rays(std::size_t n) const {
  if (n == 0) return {};
  if (const auto* const floats = std::get_if<std::vector<Ray>>(&rows_))
    return Rays::of(std::span(*floats).first(n));
  const auto& rows = std::get<Rows<double, 8>>(rows_);
  const std::span<const double> values(rows.front().data(), 8 * rows.size());
  constexpr std::size_t kStride = 8 * sizeof(double);
  return {{values, n, kStride},
          {values.subspan(4), n, kStride},
          {values.subspan(3), n, kStride},
          {values.subspan(7), n, kStride},
          {}};
}

Points RequestedRows::points(std::size_t n) const {
  if (n == 0) return {};
  if (const auto* const floats = std::get_if<Rows<float, 3>>(&rows_)) return {floats->front().data(), n};
  return {std::get<Rows<double, 3>>(rows_).front().data(), n};
}

}  // namespace kdray::cli
