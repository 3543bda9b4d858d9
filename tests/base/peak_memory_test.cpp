// What is used and given back again is still counted; what was held before is not.
#include "base/process_memory.h"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>

namespace kdray::test {
namespace {

constexpr std::size_t kBytes = std::size_t{64} << 20, kSlack = std::size_t{16} << 20;
constexpr std::size_t kGrain = std::size_t{1} << 20;  // the system counts pages in lots

// Memory that is resident: written, and not optimised away.
std::unique_ptr<char[]> filled(std::size_t bytes) {
  std::unique_ptr<char[]> memory(new char[bytes]);
  std::memset(memory.get(), 1, bytes);
  volatile char* const seen = memory.get();
  EXPECT_EQ(seen[bytes - 1], 1);
  return memory;
}

TEST(PeakMemory, CountsWhatWorkHeldForAWhile) {
  const auto before = filled(2 * kBytes);
  const auto peak = peak_bytes_of([] { filled(kBytes); });
  if (!peak) GTEST_SKIP() << "this system doesn't tell";
  EXPECT_GE(*peak + kGrain, kBytes);
  EXPECT_LE(*peak, kBytes + kSlack);
}

TEST(PeakMemory, ForgetsEarlierPeaks) {
  filled(4 * kBytes);
  const auto peak = peak_bytes_of([] { filled(kBytes / 4); });
  if (!peak) GTEST_SKIP() << "this system doesn't tell";
  EXPECT_LE(*peak, kBytes / 4 + kSlack);
}

}  // namespace
}  // namespace kdray::test
