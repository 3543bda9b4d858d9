// What    The exact signs of the half-open rule, on floats of every size: down to those whose products no
//         float holds. Products of floats are exact in double, so comparing two of them is the answer.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray::test {
namespace {

struct Corners {
  float ax, ay, bx, by, cx, cy;
};
struct Signs {
  int difference;  // of ax*ay - bx*by
  int side;        // of the edge from a to b
  int holds;
};

const char* const kSource =
    "#include \"intersect/crossing.clh\"\n"
    "typedef struct Corners { float ax, ay, bx, by, cx, cy; } Corners;\n"
    "typedef struct Signs { int difference, side, holds; } Signs;\n"
    "__kernel void test(__global const Corners* in, __global Signs* out, uint n) {\n"
    "  const uint i = get_global_id(0);\n"
    "  if (i >= n) return;\n"
    "  const Corners c = in[i];\n"
    "  out[i].difference = sign_of_difference(c.ax, c.ay, c.bx, c.by);\n"
    "  out[i].side = side_of_edge(c.ax, c.ay, c.bx, c.by);\n"
    "  out[i].holds = holds_moved_point(c.ax, c.ay, c.bx, c.by, c.cx, c.cy);\n"
    "}\n";

int sign(double v) {
  return (v > 0) - (v < 0);
}

// Of the edge function about the point (e, e^2), for an e smaller than anything: the first term that isn't 0.
int side(double px, double py, double qx, double qy) {
  if (qx * py != qy * px) return qx * py > qy * px ? 1 : -1;
  return qy != py ? sign(qy - py) : sign(px - qx);
}

// Few mantissas, so that products are often equal; every exponent, or few.
class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  float any() {
    const std::uint32_t mantissa = next() % 4 == 0 ? next() >> 9 : (next() % 8) << 20;
    const std::uint32_t exponent = few_ ? base_ + next() % 3 : 1 + next() % 186;
    const float v = std::bit_cast<float>((next() & 1u) << 31 | exponent << 23 | mantissa);
    return next() % 16 == 0 ? 0.0f : v;
  }
  void choose() {
    few_ = next() % 4 != 0;
    base_ = 1 + next() % 180;
  }

 private:
  std::uint32_t next() { return static_cast<std::uint32_t>(random_()); }

  std::mt19937 random_;
  bool few_ = true;
  std::uint32_t base_ = 1;
};

class CrossingTest : public EachDevice {};

TEST_P(CrossingTest, SignsAreExactAtAnySize) {
  const unsigned seed = 20261124;
  SCOPED_TRACE(seed);
  Numbers numbers(seed);
  std::vector<Corners> in;
  for (int i = 0; i < 300000; ++i) {
    numbers.choose();
    Corners c{numbers.any(), numbers.any(), numbers.any(), numbers.any(), numbers.any(), numbers.any()};
    if (i % 3 == 0) c.bx = c.ax * 2, c.by = c.ay * 2;  // on a line with 0
    if (i % 7 == 0) c.by = c.ay;
    in.push_back(c);
  }
  const std::vector<Signs> out = run_kernel<Signs>(GetParam(), kSource, in);
  int zero = 0, held = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Corners& c = in[i];
    const double one = double{c.ax} * c.ay, other = double{c.bx} * c.by;
    ASSERT_EQ(out[i].difference, (one > other) - (one < other))
        << i << ": " << c.ax << " " << c.ay << " " << c.bx << " " << c.by;
    const int ab = side(c.ax, c.ay, c.bx, c.by);
    ASSERT_EQ(out[i].side, ab) << i;
    const bool holds = ab != 0 && ab == side(c.bx, c.by, c.cx, c.cy) && ab == side(c.cx, c.cy, c.ax, c.ay);
    ASSERT_EQ(out[i].holds != 0, holds) << i;
    zero += double{c.bx} * c.ay == double{c.by} * c.ax;
    held += holds;
  }
  EXPECT_GT(zero, 50000);
  EXPECT_GT(held, 5000);
}

KDRAY_FOR_EACH_DEVICE(CrossingTest);

}  // namespace
}  // namespace kdray::test
