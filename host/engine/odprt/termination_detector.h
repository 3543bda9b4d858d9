// What    How rank 0 finds out that a list of tiles is done on all ranks: that none has anything to do, and
//         nothing is on its way that could give it something.
// Shape   In waves. A rank answers a wave when it has nothing to do, with how many messages it has sent and
//         received so far of those that bring work. All is over when two waves in a row bring the same
//         counts, and as many were received as sent: nobody has received anything between its two answers,
//         so all had nothing to do at the moment between the waves, and nothing was on its way then.
// Source  F. Mattern, "Algorithms for distributed termination detection", Distributed Computing 2 (1987),
//         4.2: the four counter method.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace kdray::odprt {

struct WorkMessages {
  std::uint64_t sent = 0, received = 0;
  bool operator==(const WorkMessages&) const = default;
};

class TerminationDetector {
 public:
  explicit TerminationDetector(std::size_t n_ranks) : answers_(n_ranks) {}

  bool is_asking() const { return wave_ > n_complete_; }
  std::uint32_t wave() const { return wave_; }

  void begin_wave() { ++wave_; }
  // False: the rank has answered already, or it is no answer to this wave.
  bool answer(std::size_t rank, std::uint32_t wave, const WorkMessages& count);
  // After any of the waves.
  bool is_over() const { return is_over_; }

 private:
  void complete();

  std::vector<std::optional<WorkMessages>> answers_;
  std::size_t n_answers_ = 0;
  std::uint32_t wave_ = 0, n_complete_ = 0;
  std::optional<WorkMessages> last_;  // of all ranks, in the last wave
  bool is_over_ = false;
};

}  // namespace kdray::odprt
