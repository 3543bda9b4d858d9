// What    Which subtrees every part holds: those with most visits for their bytes, within the bytes that
//         there are.
#include "engine/odprt/assign.h"

#include <gtest/gtest.h>

namespace kdray::test {
namespace {

using Chosen = std::vector<bool>;

TEST(Replicate, MostVisitsForTheirBytesFirst) {
  const std::vector<double> visits = {10, 40, 30, 5};
  const std::vector<std::uint64_t> bytes = {10, 100, 20, 1};
  EXPECT_EQ(odprt::replicate(visits, bytes, 1), (Chosen{false, false, false, true}));
  EXPECT_EQ(odprt::replicate(visits, bytes, 21), (Chosen{false, false, true, true}));
  EXPECT_EQ(odprt::replicate(visits, bytes, 31), (Chosen{true, false, true, true}));
  EXPECT_EQ(odprt::replicate(visits, bytes, 131), (Chosen{true, true, true, true}));
}

// One that is too large doesn't keep smaller ones out.
TEST(Replicate, WhatFitsIsTaken) {
  const std::vector<double> visits = {100, 1};
  const std::vector<std::uint64_t> bytes = {50, 10};
  EXPECT_EQ(odprt::replicate(visits, bytes, 20), (Chosen{false, true}));
}

TEST(Replicate, NothingWhereNoRayComesOrNothingIsToSpare) {
  const std::vector<double> visits = {0, 3};
  const std::vector<std::uint64_t> bytes = {1, 1};
  EXPECT_EQ(odprt::replicate(visits, bytes, 10), (Chosen{false, true}));
  EXPECT_EQ(odprt::replicate(visits, bytes, 0), (Chosen{false, false}));
  EXPECT_TRUE(odprt::replicate({}, {}, 10).empty());
}

}  // namespace
}  // namespace kdray::test
