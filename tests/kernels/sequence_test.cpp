// The sequence of adaptive sampling: its first sample is the pixel's centre; the first 4, 8, ... 64 have one
// sample in every elementary interval, whatever the pixel; and pixels differ.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

struct Which {
  cl_uint pixel, k;
};
struct Point {
  float x, y;
};

class SequenceTest : public test::EachDevice {
 protected:
  std::vector<Point> points_of(cl_uint pixel, cl_uint n) {
    std::vector<Which> which;
    for (cl_uint k = 0; k < n; ++k) which.push_back({pixel, k});
    return test::run_kernel<Point>(GetParam(), R"(#include "raygen/sequence.clh"
typedef struct Which { uint pixel, k; } Which;
typedef struct Point { float x, y; } Point;
__kernel void test(__global const Which* in, __global Point* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Real2xN offset = sequence_offset((uint16)(in[i].pixel), (uint16)(in[i].k));
  const Point point = {offset.x.s7, offset.y.s7};
  out[i] = point;
}
)",
                                   which);
  }
};

// A mirrored sample that lies on the far side of its interval belongs to it.
cl_uint interval_of(float v, cl_uint n, bool from_above) {
  const double place = static_cast<double>(v) * n;
  return static_cast<cl_uint>(from_above ? std::ceil(place) - 1 : std::floor(place));
}

TEST_P(SequenceTest, EveryElementaryIntervalHasOneSample) {
  for (const cl_uint pixel : {0u, 1u, 77u, 123456u, 0x7fffffffu}) {
    const std::vector<Point> all = points_of(pixel, 64);
    // Sample 0 lies between the quarters: the others of 4 tell which side it stands for.
    int left = 0, above = 0;
    for (int k = 1; k < 4; ++k) left += all[k].x < 0.5f, above += all[k].y < 0.5f;
    for (const cl_uint n : {4u, 8u, 16u, 32u, 64u})
      for (cl_uint columns = 1; columns <= n; columns *= 2) {
        std::set<std::pair<cl_uint, cl_uint>> taken;
        for (cl_uint k = 0; k < n; ++k)
          taken.emplace(interval_of(all[k].x, columns, k == 0 && left == 1),
                        interval_of(all[k].y, n / columns, k == 0 && above == 1));
        EXPECT_EQ(taken.size(), n) << "pixel " << pixel << ", " << columns << " columns";
      }
  }
}

TEST_P(SequenceTest, BeginsInTheMiddleAndStaysInThePixel) {
  for (const cl_uint pixel : {0u, 5u, 99999u})
    for (const Point& p : points_of(pixel, 64))
      EXPECT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1) << p.x << " " << p.y;
  for (const cl_uint pixel : {0u, 5u, 99999u}) {
    const Point first = points_of(pixel, 1).front();
    EXPECT_EQ(first.x, 0.5f);
    EXPECT_EQ(first.y, 0.5f);
  }
}

// Of how many samples one is the share: of the least that have it among them, which a pixel may have.
TEST_P(SequenceTest, ShareIsTheRootOfItsPart) {
  std::vector<cl_uint> numbers(64);
  std::iota(numbers.begin(), numbers.end(), 0u);
  const std::vector<float> shares = test::run_kernel<float>(GetParam(), R"(#include "raygen/sequence.clh"
__kernel void test(__global const uint* in, __global float* out, uint n) {
  const uint i = get_global_id(0);
  if (i < n) out[i] = convert_float16(sequence_share((uint16)(in[i]))).s3;
}
)",
                                                            numbers);
  for (const cl_uint k : numbers) {
    double n = 4;
    while (n <= k) n *= 2;
    EXPECT_FLOAT_EQ(shares[k], static_cast<float>(1 / std::sqrt(n))) << "sample " << k;
  }
}

TEST_P(SequenceTest, PixelsDiffer) {
  std::set<float> second;
  for (cl_uint pixel = 0; pixel < 20; ++pixel) second.insert(points_of(pixel, 2).back().x);
  EXPECT_EQ(second.size(), 20u);
}

KDRAY_FOR_EACH_DEVICE(SequenceTest);

}  // namespace
}  // namespace kdray
