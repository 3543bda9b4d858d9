// What    When a rank asks for more tiles, and for how many: so early and so many that it never waits for
//         them, and no earlier, since tiles that lie with one rank are lost to the others at the end.
// Shape   It asks while what lies ready is less than its queues take at a time, or than they render while a
//         message goes there and back; both are measured.
// Units   Seconds of any clock.
#pragma once

#include <cstddef>
#include <optional>

namespace kdray::pdprt {

class PrefetchPolicy {
 public:
  // How many tiles are worth a message, if one is to be sent now. `stock`: what lies ready; `usual`: what is
  // taken of it at a time; `in_work`: what was taken, and may not be done.
  std::optional<std::size_t> ask(std::size_t stock, std::size_t usual, std::size_t in_work, double now);

  void granted(std::size_t n, double now);

 private:
  std::size_t during(double seconds, std::size_t not_done, double now) const;

  bool asked_ = false, any_ = false;
  double asked_at_ = 0, since_ = 0;
  double round_trip_ = 0.002;  // until it is measured
  std::size_t n_granted_ = 0;
};

}  // namespace kdray::pdprt
