// What    Makes launches fail on purpose, as if their queue's device had: so that what happens then can be
//         tested.
// Errors  ErrorCode::usage for a specification that is none.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace kdray::device {

class Faults {
 public:
  // "QUEUE@LAUNCH[,QUEUE@LAUNCH...]"; queues count from 0, launches of a queue from 1. "self-test@DEVICE"
  // among them makes the device of that number fail the self-test. Empty: none fails.
  explicit Faults(const std::string& specification = {});

  // To be called before each of a queue's launches, by that queue's thread; throws cl::Error where it is to
  // fail.
  void launch(std::size_t queue);

  bool fails_self_test(int device) const {
    return failing_devices_.contains(static_cast<std::uint64_t>(device));
  }

 private:
  struct Queue {
    std::atomic<std::uint64_t> launches{0};
    std::set<std::uint64_t> failing;
  };
  std::map<std::size_t, Queue> queues_;  // those that are to fail
  std::set<std::uint64_t> failing_devices_;
};

}  // namespace kdray::device
