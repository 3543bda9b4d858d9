// Memory for large arrays: aligned, and blocks that were freed last found again by size.
#include "base/memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

namespace kdray {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;

// Where a block of that size lay; it is freed again.
std::uintptr_t place_of(std::size_t bytes) {
  return reinterpret_cast<std::uintptr_t>(allocate(bytes).get());
}

TEST(Memory, IsAlignedForAnyVectorAndCanBeWritten) {
  for (const std::size_t bytes : {std::size_t{1}, std::size_t{1000}, 4 * kMiB, 33 * kMiB + 1}) {
    const std::shared_ptr<void> memory = allocate(bytes);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory.get()) % 128, 0u) << bytes;
    std::memset(memory.get(), 7, bytes);
  }
}

TEST(Memory, ALargeBlockIsFoundAgainByItsSize) {
  const std::uintptr_t a = place_of(40 * kMiB), b = place_of(48 * kMiB);
  EXPECT_EQ(place_of(40 * kMiB), a);
  EXPECT_EQ(place_of(48 * kMiB), b);
}

TEST(Memory, TwoOwnersNeverShareABlock) {
  const std::uintptr_t kept = place_of(40 * kMiB);
  const std::shared_ptr<void> one = allocate(40 * kMiB), other = allocate(40 * kMiB);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(one.get()), kept);
  EXPECT_NE(one.get(), other.get());
}

TEST(Memory, IsAskedForFromManyThreads) {
  std::vector<std::thread> threads;
  std::vector<int> spoilt(4);
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        const std::shared_ptr<void> memory = allocate((33 + (i + t) % 3) * kMiB);
        auto* const bytes = static_cast<volatile unsigned char*>(memory.get());
        bytes[0] = static_cast<unsigned char>(t);
        bytes[33 * kMiB - 1] = static_cast<unsigned char>(t);
        std::this_thread::yield();
        spoilt[t] += bytes[0] != t || bytes[33 * kMiB - 1] != t;
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(spoilt, std::vector<int>(4));
}

}  // namespace
}  // namespace kdray
