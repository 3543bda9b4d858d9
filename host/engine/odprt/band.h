// What    Renders one band of the picture: a thread for each queue, which takes its turns until no ray is
//         left anywhere.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "engine/odprt/exchange.h"
#include "engine/odprt/rank_exchange.h"
#include "engine/odprt/render.h"
#include "engine/odprt/shares.h"
#include "engine/odprt/worker_pool.h"
#include "engine/wavefront/tile_order.h"

namespace kdray::odprt {

// What the queues render together.
struct BandWork {
  std::uint32_t list = 0;                          // its number among ranks'
  std::size_t n_entries = 0;                       // of all ranks
  Shares shares;                                   // of tiles, or of runs of samples
  std::size_t first_pixel = 0, n_places = 0;       // of the film
  std::span<const layout::u32> samples = {};       // empty: tiles
  double seconds = frame::kForever;                // for which entries are begun; the others are left
  std::function<bool(layout::u32)> is_entry = {};  // with ranks: whether the list may have it
  Shares::Entries left = {};
};

class BandRun {
 public:
  BandRun(const Request& request, WorkerPool& pool, BandWork& band);

  // Blocks until the band is done, by all ranks, or a queue has failed. `progress` hears the share of the
  // tiles that have been begun.
  void run(const std::function<void(double)>& progress);

  const Exchange& exchange() const { return exchange_; }

 private:
  void take_turns(std::size_t queue);
  void take_turn(std::size_t queue, const Turn& turn, QueueState& state, HostRayQueue& pending);
  void take_entries(std::size_t queue);
  void change_part(std::size_t queue, std::uint32_t part, QueueState& state, HostRayQueue& pending);
  void launch(std::size_t queue, const Turn& turn, QueueState& state);
  bool sends_to_host(std::size_t queue, const Outbox& outbox) const;
  void hand_over(std::size_t queue, const Turn& turn, const QueueState& state);
  void wait(const std::function<void(double)>& progress);
  void close();

  const Request& request_;
  WorkerPool& pool_;
  BandWork& band_;
  Exchange exchange_;
  std::optional<RankExchange> rank_exchange_;  // with other ranks
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t n_serving_ = 0;
  std::vector<std::atomic<std::uint32_t>> tiles_left_;  // of those that a queue has taken
  // What each queue's last turn sent to each part by way of the host. It stays for the memory that it has.
  std::vector<std::vector<HostRayQueue>> sent_;
};

}  // namespace kdray::odprt
