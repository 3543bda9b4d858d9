// Rays that are none, in rays.npy through the program: one clear line and code 1 for each; and odd rays that
// are rays.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "apps/cli/program.h"
#include "support/folder.h"

namespace kdray::stress {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
using Row = std::array<float, 8>;  // origin, t_min, direction, t_max

const Row kGood = {0, 0, 5, 0, 0, 0, -1, kInfinity};
const char* const kBall =
    "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0.1\nresolution 8 8\n"
    "f 1 1 1 1 0 1 0 1\ns 0 0 0 1\n";

std::string npy(const std::vector<Row>& rays) {
  std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(rays.size()) + ", 8), }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 255);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header + std::string(reinterpret_cast<const char*>(rays.data()), rays.size() * sizeof(Row));
}

class RaysIn : public testing::Test {
 protected:
  test::Outcome trace(const std::vector<Row>& rays) {
    folder_.put("ball.nff", kBall);
    folder_.put("rays.npy", npy(rays));
    return test::kdray({"trace", "ball.nff", "--rays", "rays.npy", "-o", "hits.npy", "--no-cache"},
                       {.folder = folder_.path()});
  }
  // t of each ray.
  std::vector<float> hits() {
    const std::string bytes = folder_.get("hits.npy");
    const std::size_t begin =
        10 + static_cast<unsigned char>(bytes[8]) + 256 * static_cast<unsigned char>(bytes[9]);
    std::vector<float> t((bytes.size() - begin) / 16);
    for (std::size_t i = 0; i < t.size(); ++i) std::memcpy(&t[i], bytes.data() + begin + 16 * i, 4);
    return t;
  }
  test::Folder folder_;
};

TEST_F(RaysIn, WhatIsNoRayIsRefusedByNumber) {
  KDRAY_NEED_DEVICE();
  const auto with = [](std::size_t at, float value) {
    Row r = kGood;
    r[at] = value;
    return r;
  };
  std::vector<std::pair<Row, std::string>> bad{
      {with(6, 0), "direction is 0"}, {with(6, -0.0f), "direction is 0"}, {with(3, kNan), "t_min"},
      {with(3, kInfinity), "t_min"},  {with(3, -kInfinity), "t_min"},     {with(7, kNan), "t_max"}};
  for (const float value : {kNan, kInfinity, -kInfinity}) {
    for (const std::size_t at : {0u, 1u, 2u}) bad.emplace_back(with(at, value), "origin");
    for (const std::size_t at : {4u, 5u, 6u}) bad.emplace_back(with(at, value), "direction");
  }
  for (const auto& [row, text] : bad) {
    SCOPED_TRACE(text);
    const test::Outcome run = trace({kGood, kGood, row, kGood});
    EXPECT_TRUE(test::fails_with(run, 1, text));
    EXPECT_NE(run.err.find("ray 2"), std::string::npos) << run.err;
  }
}

// Directions of any length, intervals that are empty or end before they begin: an answer each, no complaint.
TEST_F(RaysIn, OddRaysAreAnswered) {
  KDRAY_NEED_DEVICE();
  const float tiny = std::numeric_limits<float>::denorm_min(), huge = std::numeric_limits<float>::max();
  ASSERT_TRUE(test::succeeds(trace({kGood,
                                    {0, 0, 5, 0, 0, 0, -huge, kInfinity},
                                    {0, 0, 5, 0, 0, 0, -tiny, kInfinity},  // t = 4/tiny is beyond float
                                    {0, 0, 5, 9, 0, 0, -1, 1},
                                    {0, 0, 5, 0, 0, 0, -1, -kInfinity},
                                    {0, 0, 5, -1, 0, 0, 1, kInfinity},
                                    {0, 0, 5, -9, 0, 0, 1, kInfinity},
                                    {0, 0, huge, 0, 0, 0, 1, kInfinity}})));
  const std::vector<float> t = hits();
  ASSERT_EQ(t.size(), 8);
  EXPECT_EQ(t[0], 4);
  EXPECT_FLOAT_EQ(t[1], 4 / huge);
  EXPECT_EQ(t[2], kInfinity);
  EXPECT_EQ(t[3], kInfinity);
  EXPECT_EQ(t[4], kInfinity);
  EXPECT_EQ(t[5], kInfinity);
  EXPECT_EQ(t[6], -6);  // t_min may lie behind the origin
  EXPECT_EQ(t[7], kInfinity);
}

}  // namespace
}  // namespace kdray::stress
