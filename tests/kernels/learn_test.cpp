// What is learned from leaves that packets came to, case by case.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

constexpr int kDeepest = 5;

struct Case {
  cl_uint n_leaves, n_rays, depth;
  std::array<cl_uchar, 8> halvings;
};
struct Result {
  std::array<cl_uchar, 8> halvings;
  cl_float most_apart;
};

constexpr const char* kSource = R"(#include "layout/rays.layout.h"
#include "common/stream.clh"
#include "traverse/closest.clh"
#include "traverse/stream_rays.clh"
#include "traverse/learn.clh"
typedef struct Case { uint n_leaves, n_rays, depth; u8 halvings[8]; } Case;
typedef struct Result { u8 halvings[8]; float most_apart; } Result;
__kernel void test(__global const Case* in, __global Result* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  for (int d = 0; d < 8; ++d) out[i].halvings[d] = in[i].halvings[d];
  const Yield yield = {in[i].n_leaves, in[i].n_rays};
  learn_from(yield, out[i].halvings, in[i].depth, 5);
  out[i].most_apart = most_apart_at(out[i].halvings, in[i].depth) / KDRAY_COHERENT_DISTANCE;
}
)";

using Halvings = std::array<cl_uchar, 8>;

class LearnTest : public test::EachDevice {
 protected:
  Result after(Case c) { return test::run_kernel<Result>(GetParam(), kSource, std::vector<Case>{c}).front(); }
};

TEST_P(LearnTest, FewRaysToALeafBringPacketsTogetherAndDeeperOnesWithThem) {
  EXPECT_EQ(after({1000, 2500, 2, {}}).halvings, (Halvings{0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(after({1000, 2500, 2, {0, 0, 1, 3, 1, 0}}).halvings, (Halvings{0, 0, 2, 3, 2, 2}));
  EXPECT_EQ(after({1000, 2500, kDeepest, {0, 0, 0, 0, 0, 1}}).halvings, (Halvings{0, 0, 0, 0, 0, 2}));
}

TEST_P(LearnTest, VeryFewDoSoTwice) {
  EXPECT_EQ(after({1000, 1200, 4, {}}).halvings, (Halvings{0, 0, 0, 0, 2, 2}));
}

TEST_P(LearnTest, ManyLetThemApartAgain) {
  EXPECT_EQ(after({1000, 9000, 3, {0, 0, 2, 2, 2, 2}}).halvings, (Halvings{0, 0, 2, 1, 2, 2}));
  EXPECT_EQ(after({1000, 9000, 3, {}}).halvings, Halvings{});
}

TEST_P(LearnTest, BetweenThemAndFromLittleNothingIsLearned) {
  const Halvings some = {0, 0, 2, 2, 2, 2};
  EXPECT_EQ(after({1000, 5000, 2, some}).halvings, some);
  EXPECT_EQ(after({20, 20, 2, some}).halvings, some);
  EXPECT_EQ(after({0, 0, 2, some}).halvings, some);
}

TEST_P(LearnTest, ThereIsAnEndToIt) {
  Halvings now{};
  for (int i = 0; i < 10; ++i) now = after({1000, 1000, 1, now}).halvings;
  EXPECT_EQ(now, (Halvings{0, 6, 6, 6, 6, 6}));
  EXPECT_EQ(after({1000, 1000, 1, now}).most_apart, 1.0f / 64);
}

KDRAY_FOR_EACH_DEVICE(LearnTest);

}  // namespace
}  // namespace kdray
