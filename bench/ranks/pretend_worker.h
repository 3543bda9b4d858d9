// What    One of ODPRT's queues that only pretends: it takes turns with odprt::Exchange as band.cpp and
//         worker.cpp do, with rays that are numbers of lives (lived_frame.h), and is at work for as long as
//         these cost.
// Shape   A launch goes through waves as kernels/odprt do: the deepest rays first, as far as what they lead
//         to was granted and the outbox has room for what is sent. Rays that stay are traced and shaded here;
//         shadow rays count as alive only on their way.
// Units   Seconds of a core by itself.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "bench/ranks/lived_frame.h"
#include "odprt/exchange.h"

namespace kdray::bench {

class PretendWorker {
 public:
  PretendWorker(const DividedFrame& frame, const odprt::Plan& plan, const OdprtCosts& costs,
                std::span<const std::vector<std::uint32_t>> rays_of_tile, std::uint32_t part,
                std::size_t n_parts, int max_depth);

  // Begins a turn, if there is something to do. Returns how much work it is.
  std::optional<double> begin_turn(odprt::Exchange& exchange, odprt::Shares& shares);
  // When that has ended: hands over what leaves.
  void end_turn(odprt::Exchange& exchange);

  bool is_at_work() const { return turn_.has_value(); }
  double busy() const { return busy_; }
  std::uint64_t sent() const { return n_sent_; }

 private:
  struct Place {  // of a ray in its life
    std::uint32_t life = 0;
    std::int32_t hop = 0;  // -1: made by a queue that it doesn't begin with
  };

  void take_in(odprt::Mail& mail);
  void take_entries(odprt::Shares& shares);
  double launch(const layout::Grant& grant);
  bool make_eye_rays(const layout::Grant& grant, std::size_t most);
  bool may_go(std::uint32_t level, std::size_t n, const layout::Grant& grant) const;
  bool has_room_for(const Place& ray, const layout::Grant& grant) const;
  void trace(const Place& ray);
  void end(std::uint32_t life);
  void begin(std::uint32_t life, std::int32_t hop);
  void send(const Place& ray, std::uint32_t to);
  std::uint32_t level_of(std::uint32_t life) const;

  const DividedFrame& frame_;
  const odprt::Plan& plan_;
  const OdprtCosts& costs_;
  std::span<const std::vector<std::uint32_t>> rays_of_tile_;
  std::uint32_t part_;
  std::vector<std::vector<Place>> pools_;  // by level: 0 has shadow rays from elsewhere
  std::vector<layout::u32> tiles_;         // taken; the next one last
  std::vector<std::uint32_t> eye_rays_;    // of the tile in work; the next one last
  odprt::QueueState state_;
  std::optional<odprt::Turn> turn_;
  layout::Traffic traffic_{};
  std::vector<odprt::Mail> out_;
  std::size_t n_out_ = 0, n_shadow_out_ = 0;
  double seconds_ = 0, busy_ = 0;  // of the launch; of all
  std::uint64_t n_sent_ = 0;
};

}  // namespace kdray::bench
