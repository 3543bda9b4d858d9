// What    What slices count (wavefront/counters.h) and the buffers that they work in
//         (wavefront/slice_buffers.h), against sums and sizes written out here.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "device/opencl/context.h"
#include "engine/wavefront/counters.h"
#include "engine/wavefront/slice_buffers.h"
#include "support/device.h"
#include "support/errors.h"

namespace kdray::wavefront {
namespace {

layout::Slice counted() {
  layout::Slice s{};
  s.n_primary = 1, s.n_primary_hit = 2, s.n_shadow_rays = 4, s.n_reflected = 8, s.n_refracted = 16;
  s.n_skipped_behind = 32, s.n_skipped_unlit = 64, s.n_skipped_open = 128, s.n_skipped_background = 256;
  s.n_skipped_weight = 512, s.n_skipped_depth = 1024;
  s.n_invalid = 2048, s.n_nan = 4096, s.n_pool_overflow = 8192, s.n_waves = 16384;
  s.n_of_empty_blocks = 32768;
  return s;
}

// `times` of the slice above, in counters that tell each field from the others.
void expect_times(const Counters& c, std::uint64_t times) {
  const std::uint64_t found[] = {
      c.primary,        c.primary_hit,   c.shadow,       c.reflected,          c.refracted,
      c.skipped_behind, c.skipped_unlit, c.skipped_open, c.skipped_background, c.skipped_weight,
      c.skipped_depth,  c.invalid,       c.nan,          c.pool_overflow,      c.waves,
      c.of_empty_blocks};
  std::uint64_t wanted = times;
  for (const std::uint64_t n : found) {
    EXPECT_EQ(n, wanted);
    wanted *= 2;
  }
}

TEST(Counters, AddUpEachFieldOfTheSlices) {
  const std::vector<layout::Slice> slices(3, counted());
  Counters sum = sum_of(slices);
  expect_times(sum, 3);
  EXPECT_EQ(sum.total(), 3u * (1 + 4 + 8 + 16));
  sum.launches = 5;
  Counters more = sum;
  more.add(sum);
  expect_times(more, 6);
  EXPECT_EQ(more.launches, 10u);
}

TEST(Counters, FaultsAreTold) {
  const auto faults = [](std::uint64_t Counters::*which) {
    Counters c;
    c.*which = 7;
    return test::fails([&] { check(c); }, "this is a fault of kdray", ErrorCode::internal);
  };
  EXPECT_TRUE(faults(&Counters::invalid));
  EXPECT_TRUE(faults(&Counters::nan));
  EXPECT_TRUE(faults(&Counters::pool_overflow));
  EXPECT_TRUE(test::fails([] { check(Counters(), 7); }, "7 lost their hit", ErrorCode::internal));
  check(sum_of({}));
}

class SliceBuffersTest : public test::EachDevice {};

std::size_t size_of(const cl::Buffer& buffer) {
  return buffer.getInfo<CL_MEM_SIZE>();
}

TEST_P(SliceBuffersTest, HaveRoomForWhatTheKernelsWrite) {
  const device::Context context(GetParam(), 1);
  layout::Frame frame{};
  frame.max_depth = 5;
  frame.pool_size = 96, frame.pool_capacity = capacity_for(96);
  frame.batch_size = 50, frame.batch_capacity = capacity_for(50);
  frame.shadow_capacity = 2 * frame.batch_capacity;
  EXPECT_EQ(frame.batch_capacity, 80u);  // 50 rays to whole vectors, and a vector behind the last ray
  const SliceCapacity capacity{3, 10, 0, 100};
  SliceBuffers alone(context, frame, capacity, StreamForm::of_device(frame, sizeof(double), 0));
  SliceBuffers odprt(context, frame, {3, 10, 64, 100}, StreamForm::of_odprt(frame, 0));
  if (alone.film_made.valid()) alone.film_made.get();
  if (odprt.film_made.valid()) odprt.film_made.get();
  EXPECT_EQ(size_of(alone.batch), 3 * 13 * 80 * sizeof(double));
  EXPECT_EQ(size_of(alone.pool), 3 * 4 * 11 * frame.pool_capacity * sizeof(double));
  EXPECT_EQ(size_of(alone.film), 100 * 3 * sizeof(layout::i64));
  EXPECT_EQ(size_of(alone.tiles), 10 * sizeof(layout::u32));
  EXPECT_EQ(size_of(odprt.batch), 3 * 16 * 80 * sizeof(float));
  EXPECT_EQ(size_of(odprt.pool), 3 * 5 * 16 * frame.pool_capacity * sizeof(float));
  EXPECT_EQ(size_of(odprt.shadow_rays), 3 * 15 * 160 * sizeof(float));
  EXPECT_EQ(size_of(odprt.tiles), (10 + 2 * 64 + 16) * sizeof(layout::u32));
  for (const SliceBuffers* b : {&alone, &odprt}) {
    std::size_t sum = 0;
    for (const cl::Buffer* buffer : {&b->frame, &b->tiles, &b->slices, &b->pool, &b->batch, &b->hits,
                                     &b->shadow_rays, &b->occluded, &b->film})
      sum += size_of(*buffer);
    EXPECT_EQ(b->bytes, sum);
  }
  const std::size_t beside = sizeof(layout::Frame) + size_of(alone.tiles) + size_of(alone.film);
  EXPECT_EQ(3 * StreamForm::of_device(frame, sizeof(double), 0).bytes(frame), alone.bytes - beside);
}

KDRAY_FOR_EACH_DEVICE(SliceBuffersTest);

}  // namespace
}  // namespace kdray::wavefront
