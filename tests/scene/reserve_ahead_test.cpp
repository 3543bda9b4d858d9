#include "scene/import/text_scanner.h"

#include <gtest/gtest.h>

#include <vector>

namespace kdray::scene {
namespace {

// How often a vector moves while `n` elements of `bytes` each come after `before` bytes of something else.
int moves_of(std::size_t n, std::size_t bytes, std::size_t before) {
  ReserveAhead ahead;
  std::vector<int> elements;
  int n_moves = 0;
  const std::size_t all = before + n * bytes;
  for (std::size_t i = 0; i < n; ++i) {
    const int* const at = elements.data();
    ahead.reserve(elements, all - before - i * bytes);
    elements.push_back(0);
    if (i >= 4096 && elements.data() != at) ++n_moves;
  }
  EXPECT_LE(elements.capacity(), n + n / 10 + 2 * 4096);
  return n_moves;
}

TEST(ReserveAhead, OfAnEvenTextIsMadeOnce) {
  EXPECT_EQ(moves_of(100000, 20, 0), 1);
  EXPECT_EQ(moves_of(100000, 20, 5000000), 1) << "what comes before the first does not count";
  EXPECT_EQ(moves_of(1000, 20, 0), 0);
}

TEST(ReserveAhead, StillDoublesWhereTheRestIsDenser) {
  ReserveAhead ahead;
  std::vector<int> elements;
  std::size_t left = 5000 * 1000;  // a thousand bytes each, as it seems
  int n_moves = 0;
  for (int i = 0; i < 1000000; ++i) {
    const int* const at = elements.data();
    ahead.reserve(elements, left);
    left -= i < 4500 ? 1000 : 0;
    elements.push_back(i);
    if (elements.data() != at) ++n_moves;
  }
  EXPECT_LE(n_moves, 22);
}

}  // namespace
}  // namespace kdray::scene
