#include "engine/wavefront/tile_order.h"

#include <algorithm>
#include <cstdlib>

namespace kdray::wavefront {

std::vector<Band> bands_of(const layout::Frame& frame, std::size_t max_film_bytes) {
  const std::uint32_t n_rows = frame.n_tiles / frame.n_tiles_x;
  const std::size_t row_bytes = std::size_t{frame.tile_height} * frame.width * 3 * sizeof(layout::i64);
  const auto fitting =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(max_film_bytes / row_bytes, 1, n_rows));
  std::vector<Band> bands;
  for (std::uint32_t row = 0; row < n_rows; row += fitting) {
    const std::uint32_t end = std::min(row + fitting, n_rows);
    const std::size_t y = std::size_t{row} * frame.tile_height;
    const std::size_t end_y = std::min<std::size_t>(std::size_t{end} * frame.tile_height, frame.height);
    bands.push_back({row, end - row, y * frame.width, (end_y - y) * frame.width});
  }
  return bands;
}

namespace {

struct Step {
  int x, y;
};
Step operator+(Step a, Step b) {
  return {a.x + b.x, a.y + b.y};
}
Step operator-(Step a, Step b) {
  return {a.x - b.x, a.y - b.y};
}
Step operator-(Step a) {
  return {-a.x, -a.y};
}
Step half(Step a) {
  return {a.x >> 1, a.y >> 1};
}  // rounded down, negative ones too
int length(Step a) {
  return std::abs(a.x + a.y);
}  // of a step along an axis
Step unit(Step a) {
  return {(a.x > 0) - (a.x < 0), (a.y > 0) - (a.y < 0)};
}

class Curve {
 public:
  Curve(std::uint32_t first_row, std::size_t n_tiles) : first_row_(first_row) { tiles_.reserve(n_tiles); }

  // Visits the rectangle with a corner in the tile `at` and the sides `along` and `across`, from `at` to the
  // far end of `along`.
  void visit(Step at, Step along, Step across) {
    if (length(across) == 1) return run(at, along);
    if (length(along) == 1) return run(at, across);
    if (2 * length(along) > 3 * length(across)) return visit_halves(at, along, across);
    const Step step_along = unit(along), step_across = unit(across);
    Step first = half(across);
    if (length(first) % 2 == 1 && length(across) > 2) first = first + step_across;
    const Step half_along = half(along);
    visit(at, first, half_along);
    visit(at + first, along, across - first);
    visit(at + (along - step_along) + (first - step_across), -first, -(along - half_along));
  }

  std::vector<layout::u32> take() { return std::move(tiles_); }

 private:
  // A long rectangle: one half after the other.
  void visit_halves(Step at, Step along, Step across) {
    Step first = half(along);
    if (length(first) % 2 == 1 && length(along) > 2) first = first + unit(along);
    visit(at, first, across);
    visit(at + first, along - first, across);
  }

  void run(Step at, Step along) {
    for (int i = length(along); i > 0; --i, at = at + unit(along))
      tiles_.push_back(
          KDRAY_TILE(static_cast<layout::u32>(at.x), first_row_ + static_cast<layout::u32>(at.y)));
  }

  std::uint32_t first_row_;
  std::vector<layout::u32> tiles_;
};

}  // namespace

std::vector<layout::u32> tile_curve(std::uint32_t n_columns, std::uint32_t first_row, std::uint32_t n_rows) {
  const int width = static_cast<int>(n_columns), height = static_cast<int>(n_rows);
  Curve curve(first_row, std::size_t{n_columns} * n_rows);
  width >= height ? curve.visit({0, 0}, {width, 0}, {0, height})
                  : curve.visit({0, 0}, {0, height}, {width, 0});
  return curve.take();
}

}  // namespace kdray::wavefront
