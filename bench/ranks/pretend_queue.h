// What    One of PDPRT's queues that only pretends: it takes tiles from pdprt::Tiles as the real one does, at
//         the same moments, and is at work for as long as they took in a measured frame.
// Shape   As pdprt/queue.cpp over wavefront.cpp: a list of tiles, launches of so many waves that go through
//         it, two of them in flight, and a look at the list whenever one has ended. When there is nothing
//         left to take, the list is delivered. It runs nothing itself: it says how much work comes next, and
//         hears when that is done.
// Units   Seconds of a core by itself.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "pdprt/tiles.h"

namespace kdray::bench {

// What was measured of a frame by one queue on one core.
struct ReplayedFrame {
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0;
  std::vector<layout::u32> curve;    // its tiles
  std::vector<double> tile_seconds;  // of each, in this order
  double wave_seconds = 1e-4;
  double waves_of_launch = 128;
  double prepare_seconds = 0;    // from the word that a frame begins until a rank is ready for tiles
  double begin_seconds = 0;      // of a list: from the first tiles to the first launch
  double launch_seconds = 0;     // of one that finds nothing
  double end_seconds = 0;        // of the frame: from the last sums to the picture
  double deliver_seconds = 0;    // for each tile: its sums as a record
  double take_back_seconds = 0;  // for each tile: the record's sums to where they belong

  double guessed_waves = 1;  // of a tile, before one is rendered
  // By entry; the frame's tiles alone.
  double seconds_of(layout::u32 entry) const { return by_entry[place_of(entry)]; }
  void index();                              // once curve and seconds are there
  ReplayedFrame times(double factor) const;  // on a slower core
  std::size_t place_of(layout::u32 entry) const;
  std::vector<double> by_entry = {};
};

class PretendQueue {
 public:
  using Deliver = std::function<void(std::span<const layout::u32> entries)>;

  // `list_seconds`: how long a list goes on before it is delivered; `deliver_seconds`: of a tile.
  PretendQueue(const ReplayedFrame& frame, double list_seconds, double deliver_seconds)
      : frame_(frame), list_seconds_(list_seconds), deliver_seconds_(deliver_seconds) {}

  // Tiles of another list; they have to outlive it.
  void begin(pdprt::Tiles& tiles);

  // To be called when work has ended (`ended`), or tiles may have come. What is to be done next, if anything
  // is to be begun now.
  std::optional<double> go_on(double now, bool ended, const Deliver& deliver);

  bool is_over() const { return state_ == State::over; }
  bool is_at_work() const { return state_ != State::waits && state_ != State::over; }
  std::size_t n_rendered() const { return n_told_; }
  double busy() const { return busy_; }
  std::size_t n_launches() const { return n_launches_; }

 private:
  enum class State { waits, begins, renders, delivers, over };
  struct Launch {
    std::size_t listed = 0;
  };
  struct Report {  // wavefront::Progress
    std::size_t listed = 0, taken = 0, front = 0;
    double waves = 0;
    bool at_work = false;
  };

  std::optional<double> begin_list(double now);
  bool feed(double now);
  void enqueue(double now);
  double run_next();
  double end_launch(double now, bool& is_done);
  std::size_t tiles_of_launch() const;

  const ReplayedFrame& frame_;
  double list_seconds_, deliver_seconds_;
  pdprt::Tiles* tiles_ = nullptr;
  State state_ = State::over;
  std::vector<layout::u32> list_;
  std::size_t at_ = 0;       // of the list: the tile in work
  double of_tile_ = 0;       // seconds of it that are done
  double waves_ = 0;         // of the list
  double launch_waves_ = 0;  // of the one that runs
  double waves_of_tile_ = 1;
  std::deque<Launch> in_flight_;
  Report report_;
  double since_ = 0, list_busy_ = 0, busy_ = 0;
  std::size_t n_told_ = 0, told_of_list_ = 0, n_launches_ = 0;
};

}  // namespace kdray::bench
