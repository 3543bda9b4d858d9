// What    What adaptive sampling tells of a picture: how far its pixels were refined, and the error that it
//         is believed to have.
#pragma once

#include <array>
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

struct Report {
  double target = 0, estimated_rmse = 0;
  bool met = false;  // the target; else all that could be refined has been
  int rounds = 0;    // the first one counted
  std::uint64_t samples = 0;
  std::array<std::uint64_t, kLevels> pixels{};  // by level
  std::vector<float> counts;                    // samples of each pixel
};

}  // namespace kdray::adaptive
