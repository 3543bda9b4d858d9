// What one frame leaves to the next: nothing but what it asks for, and no more than there is room for.
#include "device/opencl/buffers.h"

#include <gtest/gtest.h>

#include "device/opencl/context.h"
#include "support/device.h"

namespace kdray::device {
namespace {

class KeptBuffersTest : public test::EachDevice {
 protected:
  cl::Buffer made(std::size_t bytes) const { return context_.buffer(CL_MEM_READ_WRITE, bytes, "a test"); }

  const Context context_{GetParam(), 1};
};

TEST_P(KeptBuffersTest, WhatWasLeftIsTakenOnceByItsSize) {
  KeptBuffers kept(1000);
  const cl::Buffer a = made(300), b = made(400), empty = made(0);
  for (const cl::Buffer* buffer : {&a, &b, &empty}) kept.leave(*buffer);
  EXPECT_EQ(kept.bytes(), 300 + 400 + kLeastBufferBytes);
  EXPECT_EQ((*kept.take(400))(), b());
  EXPECT_EQ((*kept.take(0))(), empty());
  EXPECT_EQ((*kept.take(300))(), a());
  EXPECT_FALSE(kept.take(300));
  EXPECT_EQ(kept.bytes(), 0u);
}

TEST_P(KeptBuffersTest, AnotherSizeMeansThatTheOthersAreOfNoMoreUse) {
  KeptBuffers kept(1000);
  kept.leave(made(300));
  kept.leave(made(400));
  EXPECT_FALSE(kept.take(301));
  EXPECT_FALSE(kept.take(300));
  EXPECT_EQ(kept.bytes(), 0u);
}

TEST_P(KeptBuffersTest, WhatIsTooLargeToBeKeptLeavesTheOthersThere) {
  KeptBuffers kept(1000);
  kept.leave(made(300));
  EXPECT_FALSE(kept.take(1001));
  EXPECT_EQ(kept.bytes(), 300u);
  kept.clear();
  EXPECT_EQ(kept.bytes(), 0u);
}

TEST_P(KeptBuffersTest, ThereIsNoRoomForMoreThanItWasGiven) {
  KeptBuffers kept(1000);
  kept.leave(made(600));
  kept.leave(made(401));
  kept.leave(made(400));
  kept.leave(cl::Buffer());
  EXPECT_EQ(kept.bytes(), 1000u);
  EXPECT_FALSE(kept.take(401));
}

TEST_P(KeptBuffersTest, CopiesOfAContextShareThem) {
  const cl::Buffer left = context_.kept_buffer(5000, "a test");
  context_.kept_buffers().leave(left);
  EXPECT_EQ(context_.without_cache().kept_buffer(5000, "a test")(), left());
  EXPECT_NE(context_.kept_buffer(5000, "a test")(), left());
}

KDRAY_FOR_EACH_DEVICE(KeptBuffersTest);

}  // namespace
}  // namespace kdray::device
