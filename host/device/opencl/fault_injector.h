// What    Makes launches fail on purpose, in each way that one may fail (opencl_error.h): so that what
//         happens then can be tested.
// Errors  ErrorCode::usage for a malformed specification.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace kdray::device {

class FaultInjector {
 public:
  // "QUEUE@LAUNCH[:KIND][,QUEUE@LAUNCH[:KIND]...]"; queues count from 0, launches of a queue from 1. KIND is
  // "device" (when none is given), "memory" or "bug", which throw a code of OpenCL's of that class, or
  // "input", which throws an Error of kdray's own. "self-test@DEVICE" among them makes the device of that
  // number fail the self-test. Empty: none fails.
  explicit FaultInjector(const std::string& specification = {});

  // Called before each of a queue's launches, by that queue's thread; throws where the launch is to fail.
  void launch(std::size_t queue);

  bool fails_self_test(int device) const {
    return failing_devices_.contains(static_cast<std::uint64_t>(device));
  }

 private:
  enum class Kind { device, memory, bug, input };
  static std::optional<Kind> kind_of(std::string_view name);

  struct Queue {
    std::atomic<std::uint64_t> launches{0};
    std::map<std::uint64_t, Kind> failing;  // by the launch's number
  };
  std::map<std::size_t, Queue> queues_;  // those that are to fail
  std::set<std::uint64_t> failing_devices_;
};

}  // namespace kdray::device
