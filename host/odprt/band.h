// What    Renders one band of the picture: a thread for each queue, which takes its turns until no ray is left anywhere.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "odprt/crew.h"
#include "odprt/exchange.h"
#include "odprt/render.h"
#include "wavefront/bands.h"

namespace kdray::odprt {

// What the queues render together.
struct BandWork {
  std::vector<layout::u32> list;              // entries: tiles, along the curve, or runs of samples
  std::size_t first_pixel = 0, n_places = 0;  // of the film
  std::span<const layout::u32> samples = {};  // empty: tiles
};

class BandRun {
 public:
  BandRun(const Request& request, Crew& crew);

  // Blocks until the band is done or a queue has failed. `progress` hears the share of the tiles that have been begun.
  void run(const BandWork& band, const std::function<void(double)>& progress);

  const Exchange& exchange() const { return exchange_; }

 private:
  void serve(std::size_t queue);
  void take_turns(std::size_t queue);
  void take_turn(std::size_t queue, const Turn& turn, QueueState& state, Mail& pending);
  void change_part(std::size_t queue, std::uint32_t part, QueueState& state, Mail& pending);
  void launch(std::size_t queue, const Turn& turn, QueueState& state);
  void hand_over(std::size_t queue, const Turn& turn, const QueueState& state);
  void wait(const BandWork& band, const std::function<void(double)>& progress);

  const Request& request_;
  Crew& crew_;
  Exchange exchange_;
  std::atomic<std::size_t> n_serving_{0};
  std::vector<std::atomic<std::uint32_t>> tiles_left_;  // by queue
};

}  // namespace kdray::odprt
