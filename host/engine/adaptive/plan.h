// What    How far to refine pixels for a target error: until another sample gains equally little in any of
//         them.
// Shape   A pixel of n samples with the squared error v has the price v/n, by which pixels are counted. Each
//         is refined level by level until its price is not above a limit; the limit is the highest for which
//         the errors add up to what is wanted.
// Why     Counts are whole numbers: the sum and the limit are the same in whatever order pixels come.
// Source  Neyman, "On the two different aspects of the representative method", 1934, for the allocation.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace kdray::adaptive {

// How many samples a pixel has at each level of refinement. There is no level of two, which tell next to
// nothing of their spread.
constexpr std::array<std::uint32_t, 6> kSamples = {1, 4, 8, 16, 32, 64};
constexpr int kLevels = kSamples.size();

constexpr std::uint32_t samples_of(int level) {
  return kSamples[static_cast<std::size_t>(level)];
}

// What adaptive sampling tells of a picture: how far its pixels were refined, and the error that it is
// believed to have.
struct Report {
  double target = 0, estimated_rmse = 0;
  bool met = false;  // the target; else all that could be refined has been
  int rounds = 0;    // the first one counted
  std::uint64_t samples = 0;
  std::array<std::uint64_t, kLevels> pixels{};  // by level
  std::vector<float> counts;                    // samples of each pixel
};

// A pixel's squared error at a level, as a share of its samples' variance: n^-1.5, as of stratified samples
// of an edge. A single sample lies in the centre, which halves it.
float remains_at(int level);

// How far a pixel is to be refined: until its price is not above the limit, by `most` levels at most.
struct Refined {
  int level;
  double price;
};
Refined refined(int level, double price, double limit_price, int most = kLevels);

// Pixels by level and price, eight classes to each power of two.
class Prices {
 public:
  static constexpr std::uint32_t kClasses = 2048;

  // The class 0 means that there is no error.
  static std::uint32_t class_of(float price) { return std::bit_cast<std::uint32_t>(price) >> 20; }
  static float price_of(std::uint32_t number) {
    return number == 0 ? 0.0f : std::bit_cast<float>(number << 20 | 1u << 19);
  }

  void add(int level, std::uint32_t number) { ++counts_[at(level, number)]; }
  void remove(int level, std::uint32_t number) { --counts_[at(level, number)]; }
  void add(const Prices& other);

  std::uint64_t pixels(int level) const;

  // The sum of all pixels' squared errors, if those whose price is above the limit were refined.
  double sum_for(std::uint32_t limit) const;
  double sum() const { return sum_for(kClasses); }

  // The limit at which that sum becomes `wanted`. Where it can't, the limit leaves little more than what must
  // be left anyway.
  std::uint32_t limit_for(double wanted) const;

 private:
  static std::size_t at(int level, std::uint32_t number) {
    return static_cast<std::size_t>(level) * kClasses + number;
  }

  std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(kLevels * kClasses);
};

}  // namespace kdray::adaptive
