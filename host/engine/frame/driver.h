// What    Renders a frame by an executor: all its tiles, band by band, and with adaptive sampling rounds of
//         samples; with a checkpoint only what that lacks; and tells the progress.
// Shape   A round is what is finished together: all tiles, or all runs of a list of samples. It is cut into
//         stretches, for which the films have places, and each stretch is a list of the executor's.
// Errors  Those of the executor, of the checkpoint and of Request::progress.
// Source  docs/design/checkpoint.md and adaptive.md.
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
#include "engine/frame/result.h"
#include "engine/wavefront/develop.h"
#include "engine/wavefront/tile_order.h"
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

// A scheme of parallel ray tracing as the frame's driver sees it: PDPRT and ODPRT render lists
// of entries, and hand their sums to a sink. Errors: Those of the scheme, which also decides what becomes
// of a failed queue. Ranks: Rank 0's driver begins the lists; the other ranks follow.
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

// Fills in the picture, its samples, the time, and how it was cut. On ranks other than 0 there is no picture.
void render_frame(Executor& executor, const Request& request, Result& result);

}  // namespace kdray::frame
