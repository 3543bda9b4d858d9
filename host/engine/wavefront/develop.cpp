#include "engine/wavefront/develop.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <vector>

// Of a function in several forms (target_clones) one is chosen while the program is being loaded, before a
// sanitizer is ready for any code: with sanitizers there is one form.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define KDRAY_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define KDRAY_SANITIZED
#endif
#endif

namespace kdray::wavefront {

namespace {

constexpr std::size_t kGrain = 3 << 15;  // sums to a task: 1 MiB of them and of the picture

// A queue's thread lasts as long as a picture, and TBB makes an arena for each thread that has none, of which
// 2021.8 (Debian 12) never gives some memory back: threads share one, which is left to the process, since
// they may outlive what is static.
tbb::task_arena& shared_arena() {
  static tbb::task_arena& arena = *new tbb::task_arena;
  return arena;
}

// Calls take(begin, end) for parts of [0, n), of `grain` elements or more.
template <class Take>
void in_shares(std::size_t n, std::size_t grain, const Take& take) {
  shared_arena().execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain),
                      [&](const auto& range) { take(range.begin(), range.end()); });
  });
}

// Neighbouring tiles of one row.
struct TileSpan {
  std::uint32_t row, first_column, end_column;
};

// Spans as long as can be: sums and picture are read and written in the order in which they lie.
std::vector<TileSpan> spans_of(std::span<const layout::u32> tiles) {
  std::vector<layout::u32> sorted;  // by row, then by column
  if (!std::ranges::is_sorted(tiles)) {
    sorted.assign(tiles.begin(), tiles.end());
    std::ranges::sort(sorted);
    tiles = sorted;
  }
  std::vector<TileSpan> spans;
  for (const layout::u32 tile : tiles) {
    const std::uint32_t row = KDRAY_TILE_ROW(tile), column = KDRAY_TILE_COLUMN(tile);
    if (!spans.empty() && spans.back().row == row && spans.back().end_column == column)
      ++spans.back().end_column;
    else
      spans.push_back({row, column, column + 1});
  }
  return spans;
}

// Calls take(x, y, n) for the pixels of the tiles, row by row: n from this one on.
template <class Take>
void for_each_row(const layout::Frame& frame, std::span<const layout::u32> tiles, const Take& take) {
  const auto take_span = [&](const TileSpan& span) {
    const std::size_t x = std::size_t{span.first_column} * frame.tile_width;
    const std::size_t end_x =
        std::min<std::size_t>(std::size_t{span.end_column} * frame.tile_width, frame.width);
    const std::size_t end_y =
        std::min<std::size_t>((std::size_t{span.row} + 1) * frame.tile_height, frame.height);
    for (std::size_t y = std::size_t{span.row} * frame.tile_height; y < end_y; ++y) take(x, y, end_x - x);
  };
  const std::vector<TileSpan> spans = spans_of(tiles);
  in_shares(spans.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) take_span(spans[i]);
  });
}

// This is compiled for vectors of eight as well, where the processor has them: the conversions of 64-bit
// whole numbers are instructions there, of eight at once. Each operation is rounded by itself, so the values
// are the same.
#if defined(__x86_64__) && defined(__linux__) && !defined(KDRAY_SANITIZED)
__attribute__((target_clones("arch=x86-64-v4", "default")))
#endif
void scale_sums(const layout::i64* sums, std::size_t n, double scale, float* values) {
  for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<float>(static_cast<double>(sums[i]) * scale);
}

// The films' sums from `first` on.
void add_pieces(Films films, std::size_t first, std::span<layout::i64> sums) {
  constexpr auto kLeast = std::numeric_limits<layout::i64>::min(),
                 kMost = std::numeric_limits<layout::i64>::max();
  const auto begin = films.front().begin() + static_cast<std::ptrdiff_t>(first);
  std::copy(begin, begin + static_cast<std::ptrdiff_t>(sums.size()), sums.begin());
  for (const auto& film : films.subspan(1))
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const layout::i64 more = film[first + i];
      if (__builtin_add_overflow(sums[i], more, &sums[i])) sums[i] = more < 0 ? kLeast : kMost;
    }
}

class Developer {
 public:
  explicit Developer(std::uint32_t samples)
      : scale_(1.0 / (static_cast<double>(KDRAY_FILM_SCALE) * samples)) {}

  // The films' sums from `first` on.
  void operator()(Films films, std::size_t first, std::span<float> rgb) const {
    if (films.size() == 1) return scale_sums(films.front().data() + first, rgb.size(), scale_, rgb.data());
    std::vector<layout::i64> sums(rgb.size());
    add_pieces(films, first, sums);
    scale_sums(sums.data(), rgb.size(), scale_, rgb.data());
  }

 private:
  double scale_;
};

}  // namespace

void develop(Films films, int samples, std::span<float> rgb) {
  const Developer developer(static_cast<std::uint32_t>(samples));
  in_shares(rgb.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    developer(films, begin, rgb.subspan(begin, end - begin));
  });
}

void add_up(Films films, std::span<layout::i64> sums) {
  in_shares(sums.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    add_pieces(films, begin, sums.subspan(begin, end - begin));
  });
}

void develop_tiles(const PlacedFilms& from, const layout::Frame& frame, std::span<const layout::u32> tiles,
                   std::span<float> picture) {
  const Developer developer(frame.n_samples);
  for_each_row(frame, tiles, [&](std::size_t x, std::size_t y, std::size_t n) {
    developer(from.films, from.at(x, y), picture.subspan(3 * (y * frame.width + x), 3 * n));
  });
}

void copy_tiles(const PlacedFilms& from, const layout::Frame& frame, std::span<const layout::u32> tiles,
                std::span<layout::i64> picture_sums) {
  for_each_row(frame, tiles, [&](std::size_t x, std::size_t y, std::size_t n) {
    add_pieces(from.films, from.at(x, y), picture_sums.subspan(3 * (y * frame.width + x), 3 * n));
  });
}

void copy_runs(const PlacedFilms& from, std::span<const layout::u32> runs, std::span<layout::i64> sums) {
  constexpr std::size_t kRun = KDRAY_SAMPLE_RUN;
  in_shares(runs.size(), kGrain / (3 * kRun), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      add_pieces(from.films, from.at(runs[i] * kRun, 0), sums.subspan(3 * kRun * runs[i], 3 * kRun));
  });
}

}  // namespace kdray::wavefront
