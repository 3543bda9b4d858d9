// What    Where the sums of finished entries go: into the picture, or to where a checkpoint or adaptive
//         sampling wants them.
// Shape   A tile or a run is handed over once, by films or as a rectangle. A picture of which neither a
//         checkpoint nor further rounds want the sums is developed tile by tile, and needs none.
// Threads Several at once, with entries of their own.
#pragma once

#include <cstddef>
#include <span>

#include "base/vec.h"
#include "engine/checkpoint/record.h"
#include "engine/wavefront/develop.h"
#include "layout/frame.layout.h"

namespace kdray::frame {

class Sink {
 public:
  virtual ~Sink() = default;

  // The sums are the films' together; these begin with `first_place` of the picture, or of the samples.
  virtual void take_films(wavefront::Films films, std::size_t first_place,
                          std::span<const layout::u32> entries) = 0;
  // An entry's sums alone, row by row: from another rank.
  virtual void take_sums(layout::u32 entry, checkpoint::Sums sums) = 0;
};

// Develops tiles into the pixels of the picture.
class PictureSink final : public Sink {
 public:
  PictureSink(const layout::Frame& frame, std::span<vec3> pixels) : frame_(frame), pixels_(pixels) {}

  void take_films(wavefront::Films films, std::size_t first_place,
                  std::span<const layout::u32> tiles) override;
  void take_sums(layout::u32 tile, checkpoint::Sums sums) override;

 private:
  const layout::Frame& frame_;
  std::span<vec3> pixels_;
};

// Keeps the sums of tiles: three for each pixel of the picture.
class TileSums final : public Sink {
 public:
  TileSums(const layout::Frame& frame, std::span<layout::i64> sums) : frame_(frame), sums_(sums) {}

  void take_films(wavefront::Films films, std::size_t first_place,
                  std::span<const layout::u32> tiles) override;
  void take_sums(layout::u32 tile, checkpoint::Sums sums) override;

 private:
  const layout::Frame& frame_;
  std::span<layout::i64> sums_;
};

// Keeps the sums of runs: three for each sample.
class RunSums final : public Sink {
 public:
  explicit RunSums(std::span<layout::i64> sums) : sums_(sums) {}

  void take_films(wavefront::Films films, std::size_t first_place,
                  std::span<const layout::u32> runs) override;
  void take_sums(layout::u32 run, checkpoint::Sums sums) override;

 private:
  std::span<layout::i64> sums_;
};

}  // namespace kdray::frame
