// What    The word of KDRAY_RAY_FINDER (layout/rays.layout.h) as host and device pack it and take it apart,
//         against its fields: part, depth, and the part that the ray goes to.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "layout/odprt.layout.h"
#include "layout/rays.layout.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray::odprt {
namespace {

struct Way {
  std::uint32_t part, depth, to;
};
struct Word {
  std::uint32_t sent, part, depth, to;  // the word, and what is read out of it
};

const char* const kSource = R"(
#define KDRAY_ODPRT 1
#include "layout/rays.layout.h"
typedef struct Way { uint part, depth, to; } Way;
typedef struct Word { uint sent, part, depth, to; } Word;
__kernel void test(__global const Way* in, __global Word* out, uint n) {
  const uint i = (uint)get_global_id(0);
  if (i >= n) return;
  const uint16 part = (uint16)(in[i].part), to = (uint16)(in[i].to);
  const uint16 word = KDRAY_FINDER_TO(KDRAY_FINDER(part, in[i].depth), to);
  out[i].sent = word.s7;
  out[i].part = KDRAY_FINDER_PART(word).s7;
  out[i].depth = KDRAY_FINDER_DEPTH(word).s7;
  out[i].to = KDRAY_FINDER_GOES_TO(word).s7;
}
)";

std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (const std::uint32_t part : {0u, 1u, KDRAY_MAX_PARTS - 1u, KDRAY_NO_PART})
    for (std::uint32_t depth = 1; depth <= KDRAY_MAX_DEPTH; ++depth)
      for (std::uint32_t to = 0; to < KDRAY_MAX_PARTS; to += to < 64 ? 1 : 31)
        ways.push_back({part, depth, to});
  return ways;
}

// By its fields, the lowest first.
std::uint32_t word_of(const Way& way) {
  return way.part + 4096 * (way.depth + 128 * way.to);
}

Word on_host(const Way& way) {
  const std::uint32_t word = KDRAY_FINDER_TO(KDRAY_FINDER(way.part, way.depth), way.to);
  return {word, KDRAY_FINDER_PART(word), KDRAY_FINDER_DEPTH(word), KDRAY_FINDER_GOES_TO(word)};
}

void expect_right(const Way& way, const Word& word) {
  EXPECT_EQ(word.sent, word_of(way));
  EXPECT_EQ(word.part, way.part);
  EXPECT_EQ(word.depth, way.depth);
  EXPECT_EQ(word.to, way.to);
}

TEST(Finder, TheHostPacksIt) {
  for (const Way& way : all_ways()) expect_right(way, on_host(way));
}

class FinderTest : public test::EachDevice {};

TEST_P(FinderTest, TheDevicePacksIt) {
  const std::vector<Way> ways = all_ways();
  const auto words = test::run_kernel<Word>(GetParam(), kSource, ways);
  for (std::size_t i = 0; i < ways.size(); ++i) expect_right(ways[i], words[i]);
}

KDRAY_FOR_EACH_DEVICE(FinderTest);

}  // namespace
}  // namespace kdray::odprt
