#include "engine/adaptive/contrast.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace kdray::adaptive {

namespace {

constexpr std::size_t kRows = 32;  // to a task

// A row's channels as floats, with a pixel more at both ends.
struct Row {
  std::vector<float> channel[3];
};

void read_row(std::span<const layout::i64> sums, Size size, std::size_t y, Row& row) {
  constexpr float kUnit = 1 / KDRAY_FILM_SCALE;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& values = row.channel[c];
    values.resize(size.width + 2);
    const layout::i64* const from = sums.data() + 3 * y * size.width + c;
    for (std::size_t x = 0; x < size.width; ++x) values[x + 1] = static_cast<float>(from[3 * x]) * kUnit;
    values.front() = values[1];
    values.back() = values[size.width];
  }
}

// Estimates the variances of a row of pixels, given the rows above and below it. The squares of the four
// lines' differences are summed over the channels before the largest is taken.
void contrast_of_row(const Row& above, const Row& row, const Row& below, std::span<float> variance) {
  const auto square = [&](std::size_t x, std::size_t c, const Row& first, std::size_t a, const Row& last,
                          std::size_t b) {
    const float d = first.channel[c][a] + last.channel[c][b] - 2 * row.channel[c][x + 1];
    return d * d;
  };
  for (std::size_t x = 0; x < variance.size(); ++x) {
    float across = 0, down = 0, falling = 0, rising = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      across += square(x, c, row, x, row, x + 2);
      down += square(x, c, above, x + 1, below, x + 1);
      falling += square(x, c, above, x, below, x + 2);
      rising += square(x, c, below, x, above, x + 2);
    }
    variance[x] = std::max(std::max(across, down), std::max(falling, rising)) * (1.0f / 36);
  }
}

}  // namespace

void contrast(std::span<const layout::i64> sums, Size size, std::span<float> variance) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size.height, kRows), [&](const auto& range) {
    Row rows[3];  // y - 1, y, y + 1, in turn
    read_row(sums, size, range.begin() - std::min<std::size_t>(range.begin(), 1), rows[0]);
    read_row(sums, size, range.begin(), rows[1]);
    for (std::size_t y = range.begin(); y < range.end(); ++y) {
      read_row(sums, size, std::min<std::size_t>(y + 1, size.height - 1), rows[2]);
      contrast_of_row(rows[0], rows[1], rows[2], variance.subspan(y * size.width, size.width));
      std::swap(rows[0], rows[1]);
      std::swap(rows[1], rows[2]);
    }
  });
}

}  // namespace kdray::adaptive
