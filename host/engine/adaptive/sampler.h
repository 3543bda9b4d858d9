// What    Adaptive sampling: which samples a picture is to have, round by round, until its error is believed
//         to be what is wanted.
// Shape   A first round of one sample through each pixel's centre, which a mode renders as any frame. Then
//         rounds of single samples (frame.layout.h: runs of them), of which the light of each comes back: a
//         pixel has the first 4, 8, 16, 32 or 64 of its sequence (kernels/raygen/sequence.clh). Between
//         rounds each pixel's error is estimated from the spread of its samples and its neighbours' (or, of a
//         single sample, from the contrast), and those that cost least for what they bring are refined
//         (plan.h).
// Why     All that is decided is decided from the film's whole numbers, pixel by pixel: it is the same in
//         every mode, and so is the picture.
// Source  T. Whitted, "An improved illumination model for shaded display", CACM 1980; D. Mitchell,
//         "Generating antialiased images at low sampling densities", SIGGRAPH 1987. docs/design/adaptive.md.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "engine/adaptive/blocks.h"
#include "engine/adaptive/plan.h"
#include "layout/frame.layout.h"

namespace kdray::adaptive {

class Sampler {
 public:
  // `target` is the RMSE that is wanted, over all channels of linear RGB. `noisy`: a pixel's samples differ
  // where the picture is even, too, since each sees another place of a light or of the lens. Of such noise
  // one sample tells nothing, so that every pixel gets four.
  Sampler(Size size, double target, bool noisy = false);

  // The first round's sums are written here, three for each pixel.
  std::span<layout::i64> first_sums() { return sums_; }

  // The next round's samples, in whole runs. When there are none, the picture is done.
  std::span<const layout::u32> next();

  // Takes the light of the last round's samples: three sums for each place of its runs.
  void take(std::span<const layout::i64> sums);

  std::vector<float> picture() const;  // RGB
  Report report() const;

 private:
  class Errors;

  void begin();
  bool refined_around(std::size_t block) const;
  template <class ErrorOf>
  void estimate_block(std::size_t block, Prices& changes, const ErrorOf& error_of);
  void estimate(std::span<const std::size_t> blocks);
  int next_level(std::size_t pixel) const;
  bool refines_all() const { return noisy_ && rounds_ == 1; }
  void list();

  Size size_;
  double target_;
  Blocks blocks_;
  int rounds_ = 1;
  bool noisy_;
  bool met_ = false;
  std::uint32_t limit_ = 0;
  std::vector<layout::i64> sums_;
  std::vector<double> squares_;  // of samples, summed over the channels
  std::vector<float> variance_;  // of a sample, by the pixel's own samples or contrast; mean of the channels
  std::vector<std::uint16_t> class_;  // of the price
  std::vector<std::uint8_t> level_;
  Prices prices_;
  std::vector<std::uint8_t> refined_;        // by block: whether some pixel is
  std::vector<std::uint16_t> dearest_;       // by block, of the pixels that can be refined
  std::vector<std::size_t> changed_;         // blocks, since the last estimate
  std::vector<std::size_t> first_of_block_;  // in the list: by block, and the end
  std::vector<layout::u32> list_;
};

}  // namespace kdray::adaptive
