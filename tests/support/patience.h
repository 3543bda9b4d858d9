// What    How long a test waits for something before it says that it never comes.
// Why     A machine may be busy, and may have to compile kernels first: nothing is expected of how long
//         anything takes, but what hangs has to end as a failure that says where.
#pragma once

#include <chrono>
#include <thread>

namespace kdray::test {

inline constexpr double kPatience = 600;  // seconds; below CTest's own limit

// Whether the condition holds, now or before patience ends.
template <class Condition>
bool comes_true(const Condition& condition) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(kPatience);
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace kdray::test
