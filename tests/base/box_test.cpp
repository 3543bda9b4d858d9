#include "base/box.h"

#include <gtest/gtest.h>

namespace kdray {
namespace {

TEST(Box, StartsEmptyAndGrows) {
  Box box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.area(), 0.0f);
  box.grow(vec3(1, 2, 3));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.area(), 0.0f);  // a point
  box.grow(vec3(2, 4, 6));
  EXPECT_EQ(box.area(), 2.0f * (1 * 2 + 2 * 3 + 3 * 1));
  EXPECT_EQ(box.center(), vec3(1.5f, 3, 4.5f));
}

TEST(Box, AnEmptyBoxIsNeutral) {
  Box box{vec3(0), vec3(1)};
  box.grow(Box{});
  EXPECT_EQ(box.lo, vec3(0));
  EXPECT_EQ(box.hi, vec3(1));
  EXPECT_TRUE(box.contains(Box{}));
}

TEST(Box, IntersectionOfDisjointBoxesIsEmptyAndOfTouchingOnesFlat) {
  const Box a{vec3(0), vec3(1)};
  EXPECT_TRUE(intersection(a, Box{vec3(2), vec3(3)}).empty());
  const Box flat = intersection(a, Box{vec3(1, 0, 0), vec3(2, 1, 1)});
  EXPECT_FALSE(flat.empty());
  EXPECT_EQ(flat.extent().x, 0.0f);
  EXPECT_EQ(flat.area(), 2.0f);
}

}  // namespace
}  // namespace kdray
