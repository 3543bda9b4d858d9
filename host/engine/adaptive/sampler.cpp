#include "engine/adaptive/sampler.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/adaptive/blocks.h"
#include "engine/adaptive/contrast.h"

namespace kdray::adaptive {

namespace {

constexpr float kNeighbours = 2;  // samples that the neighbours' variance counts as
constexpr float kSpill = 0.25f;   // of refined neighbours' variance, that a pixel of one sample may have
constexpr int kFirstLevels = 2;   // that a pixel is refined by at most, on no more than its contrast
constexpr double kAim = 0.9;      // at that part of the target, so that it is met without many small rounds

constexpr double kUnit = 1.0 / static_cast<double>(KDRAY_FILM_SCALE);

template <class Body>
void for_each_of(std::size_t n, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

// Where in a list of runs sample i's entry is; its number lies a run's length behind.
std::size_t place_of(std::size_t i) {
  return i / KDRAY_SAMPLE_RUN * 2 * KDRAY_SAMPLE_RUN + i % KDRAY_SAMPLE_RUN;
}

// Adds as the kernels do: a sum that is too large stays at the end of the range.
layout::i64 add_saturated(layout::i64 a, layout::i64 b) {
  layout::i64 sum = 0;
  if (!__builtin_add_overflow(a, b, &sum)) return sum;
  return b < 0 ? std::numeric_limits<layout::i64>::min() : std::numeric_limits<layout::i64>::max();
}

double square_of(const layout::i64* sums) {
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    const double value = static_cast<double>(sums[c]) * kUnit;
    square += value * value;
  }
  return square;
}

// The unbiased estimate of a single sample's variance, as the mean over the channels.
float variance_of(const layout::i64* sums, double squares, double n) {
  return static_cast<float>(std::max(0.0, squares - square_of(sums) / n) / (3 * (n - 1)));
}

}  // namespace

Sampler::Sampler(Size size, double target, bool noisy)
    : size_(size),
      target_(target),
      blocks_(size),
      noisy_(noisy),
      sums_(3 * size.pixels()),
      squares_(size.pixels()),
      variance_(size.pixels()),
      class_(size.pixels()),
      level_(size.pixels()),
      refined_(blocks_.count()),
      dearest_(blocks_.count()) {}

void Sampler::begin() {
  contrast(sums_, size_, variance_);
  changed_.resize(blocks_.count());
  std::iota(changed_.begin(), changed_.end(), std::size_t{0});
}

// Tells the squared error of the mean of a pixel's samples, for the pixels of a block. Few samples may agree
// by chance, so the neighbours' variance counts like some more.
class Sampler::Errors {
 public:
  Errors(const Sampler& sampler, std::size_t block)
      : sampler_(sampler),
        variances_(sampler.blocks_, block, [&](std::size_t pixel) { return sampler.variance_[pixel]; }),
        refined_(sampler.blocks_, block, [&](std::size_t pixel) {
          return sampler.level_[pixel] > 0 ? sampler.variance_[pixel] : 0.0f;
        }) {}

  float of(std::size_t pixel, std::uint32_t x, std::uint32_t y) const {
    const float each = 1.0f / static_cast<float>(std::max(neighbours_of(x, y, sampler_.size_), 1u));
    const float variance = sampler_.variance_[pixel];
    const int level = sampler_.level_[pixel];
    if (level == 0) return remains_at(0) * std::max(variance, kSpill * refined_.sum(x, y) * each);
    const float own = static_cast<float>(samples_of(level) - 1);
    return remains_at(level) * (own * variance + kNeighbours * variances_.sum(x, y) * each) /
           (own + kNeighbours);
  }

 private:
  const Sampler& sampler_;
  const Neighbours variances_, refined_;
};

// Counts the block's pixels anew, by the prices that follow from error_of(pixel, x, y).
template <class ErrorOf>
void Sampler::estimate_block(std::size_t block, Prices& changes, const ErrorOf& error_of) {
  const bool first = rounds_ == 1;
  std::uint16_t dearest = 0;
  blocks_.for_each_by_rows(block, [&](std::size_t pixel, std::uint32_t x, std::uint32_t y) {
    const int level = level_[pixel];
    const float price = error_of(pixel, x, y) / static_cast<float>(samples_of(level));
    const auto number = static_cast<std::uint16_t>(Prices::class_of(price));
    if (first || number != class_[pixel]) {
      if (!first) changes.remove(level, class_[pixel]);
      class_[pixel] = number;
      changes.add(level, number);
    }
    if (level + 1 < kLevels) dearest = std::max(dearest, number);
  });
  dearest_[block] = dearest;
}

void Sampler::estimate(std::span<const std::size_t> blocks) {
  tbb::enumerable_thread_specific<Prices> changes;
  for_each_of(blocks.size(), [&](std::size_t i) {
    if (refined_around(blocks[i])) {
      const Errors errors(*this, blocks[i]);
      estimate_block(blocks[i], changes.local(), [&](std::size_t pixel, std::uint32_t x, std::uint32_t y) {
        return errors.of(pixel, x, y);
      });
    } else {
      estimate_block(blocks[i], changes.local(), [&](std::size_t pixel, std::uint32_t, std::uint32_t) {
        return remains_at(0) * variance_[pixel];
      });
    }
  });
  for (const Prices& of_thread : changes) prices_.add(of_thread);
}

bool Sampler::refined_around(std::size_t block) const {
  const auto around = blocks_.around(block);
  return std::any_of(around.begin(), around.end(), [&](std::size_t other) { return refined_[other] != 0; });
}

// The level that the next round brings the pixel to. It goes as far as the limit says, since samples of one
// pixel that are traced together cost less than those of several rounds.
int Sampler::next_level(std::size_t pixel) const {
  const int level = level_[pixel];
  if (class_[pixel] <= limit_) return noisy_ ? std::max(level, 1) : level;
  const int most = level == 0 ? kFirstLevels : kLevels;
  return refined(level, Prices::price_of(class_[pixel]), Prices::price_of(limit_), most).level;
}

void Sampler::list() {
  first_of_block_.assign(blocks_.count() + 1, 0);
  for_each_of(blocks_.count(), [&](std::size_t block) {
    if (dearest_[block] <= limit_ && !refines_all()) return;
    std::size_t n = 0;
    blocks_.for_each(block, [&](std::size_t pixel, std::uint32_t, std::uint32_t) {
      n += samples_of(next_level(pixel)) - samples_of(level_[pixel]);
    });
    first_of_block_[block + 1] = n;
  });
  std::partial_sum(first_of_block_.begin(), first_of_block_.end(), first_of_block_.begin());
  const std::size_t n_runs = (first_of_block_.back() + KDRAY_SAMPLE_RUN - 1) / KDRAY_SAMPLE_RUN;
  list_.assign(n_runs * 2 * KDRAY_SAMPLE_RUN, KDRAY_NO_SAMPLE);
  for_each_of(blocks_.count(), [&](std::size_t block) {
    std::size_t i = first_of_block_[block];
    if (i == first_of_block_[block + 1]) return;
    blocks_.for_each(block, [&](std::size_t pixel, std::uint32_t x, std::uint32_t y) {
      const std::uint32_t end = samples_of(next_level(pixel));
      for (std::uint32_t k = samples_of(level_[pixel]); k < end; ++k, ++i) {
        list_[place_of(i)] = KDRAY_TILE(x, y);
        list_[place_of(i) + KDRAY_SAMPLE_RUN] = k;
      }
    });
  });
}

std::span<const layout::u32> Sampler::next() {
  if (rounds_ == 1) begin();
  estimate(changed_);
  const double pixels = static_cast<double>(size_.pixels());
  list_.clear();
  met_ = std::sqrt(prices_.sum() / pixels) <= target_ && !refines_all();
  if (met_) return {};
  limit_ = prices_.limit_for(kAim * kAim * target_ * target_ * pixels);
  list();
  return list_;
}

void Sampler::take(std::span<const layout::i64> sums) {
  ++rounds_;
  std::vector<std::uint8_t> near(blocks_.count());
  for (std::size_t block = 0; block < blocks_.count(); ++block)
    if (first_of_block_[block] < first_of_block_[block + 1])
      for (const std::size_t other : blocks_.around(block)) near[other] = 1;
  tbb::enumerable_thread_specific<Prices> changes;
  for_each_of(blocks_.count(), [&](std::size_t block) {
    const layout::i64* sample = sums.data() + 3 * first_of_block_[block];
    if (first_of_block_[block] == first_of_block_[block + 1]) return;
    Prices& prices = changes.local();
    refined_[block] = 1;
    blocks_.for_each(block, [&](std::size_t pixel, std::uint32_t, std::uint32_t) {
      const int level = next_level(pixel);
      if (level == level_[pixel]) return;
      layout::i64* const sum = &sums_[3 * pixel];
      if (level_[pixel] == 0) squares_[pixel] = square_of(sum);
      for (std::uint32_t k = samples_of(level_[pixel]); k < samples_of(level); ++k, sample += 3) {
        for (int c = 0; c < 3; ++c) sum[c] = add_saturated(sum[c], sample[c]);
        squares_[pixel] += square_of(sample);
      }
      prices.remove(level_[pixel], class_[pixel]);
      level_[pixel] = static_cast<std::uint8_t>(level);
      prices.add(level, class_[pixel]);
      variance_[pixel] = variance_of(sum, squares_[pixel], samples_of(level_[pixel]));
    });
  });
  for (const Prices& of_thread : changes) prices_.add(of_thread);
  changed_.clear();
  for (std::size_t block = 0; block < blocks_.count(); ++block)
    if (near[block]) changed_.push_back(block);
}

std::vector<float> Sampler::picture() const {
  std::array<double, kLevels> scale;
  for (int level = 0; level < kLevels; ++level)
    scale[static_cast<std::size_t>(level)] = kUnit / samples_of(level);
  std::vector<float> rgb(sums_.size());
  for_each_of(size_.height, [&](std::size_t y) {
    for (std::size_t pixel = y * size_.width; pixel < (y + 1) * size_.width; ++pixel)
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * pixel + c] =
            static_cast<float>(static_cast<double>(sums_[3 * pixel + c]) * scale[level_[pixel]]);
  });
  return rgb;
}

Report Sampler::report() const {
  Report r;
  r.target = target_;
  r.estimated_rmse = std::sqrt(prices_.sum() / static_cast<double>(size_.pixels()));
  r.met = met_;
  r.rounds = rounds_;
  for (int level = 0; level < kLevels; ++level) {
    r.pixels[static_cast<std::size_t>(level)] = prices_.pixels(level);
    r.samples += prices_.pixels(level) * samples_of(level);
  }
  r.counts.reserve(level_.size());
  for (const std::uint8_t level : level_) r.counts.push_back(static_cast<float>(samples_of(level)));
  return r;
}

}  // namespace kdray::adaptive
