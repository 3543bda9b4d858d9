// What    A scheme of parallel ray tracing as the frame's driver (driver.h) sees it: PDPRT and ODPRT render
//         lists of entries, and hand their sums to a sink.
// Errors  Those of the scheme. Each scheme also decides what becomes of a failed queue.
// Ranks   Rank 0's driver begins the lists; the other ranks follow.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/timeline.h"
#include "device/opencl/fault_injector.h"
#include "engine/checkpoint/frame_checkpoint.h"
#include "engine/wavefront/bands.h"
#include "engine/wavefront/develop.h"
#include "layout/features.h"
#include "layout/frame.layout.h"

namespace kdray::frame {

using Entries = std::vector<layout::u32>;

inline constexpr double kForever = 1e9;  // seconds

// What a scheme is asked for, whichever it is.
struct Request {
  layout::Frame frame;
  layout::Features features = 0;
  // > 0: samples where they are needed (adaptive/sampler.h); the frame then has one.
  double adaptive_target = 0;
  std::function<void(double)> progress = {};  // called from the driver's thread with the share done
  device::FaultInjector* fault_injector = nullptr;
  timeline::Timeline* timeline = nullptr;
  // What is finished already, and where it goes; its tiles are the frame's. Null: there is none.
  checkpoint::FrameCheckpoint* checkpoint = nullptr;
};

// Entries that are rendered together: tiles of a band, or runs of samples for which the films have places.
struct List {
  Entries entries = {};
  std::size_t first_place = 0, n_places = 0;  // of the films: the picture's pixels, or samples
  std::span<const layout::u32> samples = {};  // two words for each place; empty: tiles
  double seconds = kForever;                  // for which entries are begun; the others are left

  bool has_runs() const { return !samples.empty(); }
};

// Those of `all` that are not in `left`, in their order.
inline Entries without(Entries all, Entries left) {
  std::ranges::sort(left);
  std::erase_if(all, [&](layout::u32 entry) { return std::ranges::binary_search(left, entry); });
  return all;
}

// Takes the sums of entries that are finished, of each once, perhaps from several threads at a time.
using Sink = std::function<void(const wavefront::PlacedFilms&, std::span<const layout::u32> entries)>;

class Executor {
 public:
  virtual ~Executor() = default;

  virtual const layout::Frame& frame() const = 0;  // with the scheme's tiles
  // For one of them a film has places, and for so many samples, whole runs.
  virtual std::span<const wavefront::Band> bands() const = 0;
  virtual std::size_t n_samples() const = 0;

  // Returns the entries that nobody had begun when the time was over; the sink has the sums of the others.
  // `progress` hears about how many are done.
  virtual Entries render(List list, const Sink& sink, const std::function<void(double)>& progress) = 0;

  virtual bool leads() const { return true; }
  // On ranks other than 0: renders what rank 0 has begun, until it says that the frame is finished.
  virtual void follow() {}
};

}  // namespace kdray::frame
