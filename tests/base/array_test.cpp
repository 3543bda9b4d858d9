#include "base/memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace kdray {
namespace {

bool is_aligned(const void* p, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(p) % alignment == 0;
}

TEST(Array, HoldsWhatIsWritten) {
  for (const std::size_t n : {1u, 7u, 4096u, 3000000u}) {
    Array<std::uint32_t> array(n);
    ASSERT_EQ(array.size(), n);
    EXPECT_EQ(array.bytes(), 4 * n);
    std::iota(array.begin(), array.end(), 5u);
    EXPECT_EQ(array[0], 5u);
    EXPECT_EQ(array[n - 1], 5 + n - 1);
    EXPECT_EQ(array.end() - array.begin(), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(Array, FitsVectorsAndLargePages) {
  for (const std::size_t n : {1u, 100u, 1000u, 100000u})
    EXPECT_TRUE(is_aligned(Array<std::uint8_t>(n).data(), 128)) << n;
  EXPECT_TRUE(is_aligned(Array<std::uint8_t>(kLargePages).data(), std::size_t{2} << 20));
}

TEST(Array, EmptyOneHasNoMemory) {
  const Array<int> none, zero(0), copy = Array<int>::copy_of({});
  for (const Array<int>& a : {none, zero, copy}) {
    EXPECT_TRUE(a.empty());
    EXPECT_EQ(a.begin(), a.end());
    EXPECT_EQ(a.owner(), nullptr);
  }
}

TEST(Array, CopiesShareAndTheLastOneFrees) {
  bool freed = false;
  int values[] = {1, 2, 3};
  {
    Array<int> copy;
    {
      const std::shared_ptr<void> owner(values, [&freed](void*) { freed = true; });
      const Array<int> array(owner, values, 3);
      copy = array;
      EXPECT_EQ(copy.data(), array.data());
    }
    EXPECT_FALSE(freed);
    copy[1] = 7;
    const Array<int> moved = std::move(copy);
    EXPECT_EQ(moved[1], 7);
    EXPECT_FALSE(freed);
  }
  EXPECT_TRUE(freed);
  EXPECT_EQ(values[1], 7);
}

TEST(Array, CopyOfIsApart) {
  std::vector<int> values{1, 2, 3};
  const Array<int> copy = Array<int>::copy_of(values);
  values[0] = 9;
  EXPECT_EQ(std::vector<int>(copy.begin(), copy.end()), (std::vector<int>{1, 2, 3}));
}

TEST(Array, TooManyValuesAreBadAlloc) {
  constexpr std::size_t kMax = std::numeric_limits<std::size_t>::max();
  EXPECT_THROW(Array<double>{kMax / 8}, std::bad_alloc);
  EXPECT_THROW(Array<double>{kMax / 8 + 2}, std::bad_alloc);  // its bytes would wrap to 8
  EXPECT_THROW(Array<char>{kMax}, std::bad_alloc);
}

}  // namespace
}  // namespace kdray
