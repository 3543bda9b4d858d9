// Choice of devices, sub-devices and the errors of both.
#include "device/opencl/context.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include "base/memory.h"
#include "device/opencl/clock.h"
#include "device/opencl/opencl_error.h"
#include "support/device.h"
#include "support/patience.h"

namespace kdray::device {
namespace {

class ContextTest : public test::EachDevice {};

TEST_P(ContextTest, OpensTheDeviceOfThatNumber) {
  const Context context(GetParam(), 1);
  EXPECT_EQ(std::to_string(context.info().number), GetParam());
  EXPECT_EQ(context.queues().size(), 1u);
  EXPECT_GT(context.info().max_allocation, 0u);
}

TEST_P(ContextTest, GivesAsManyQueuesAsAskedFor) {
  const Context context(GetParam(), 3);
  EXPECT_EQ(context.queues().size(), 3u);
  EXPECT_GE(context.n_sub_devices(), 1u);
  EXPECT_LE(context.n_sub_devices(), 3u);
}

TEST_P(ContextTest, QueuesAreDealtOutToSeveralDevices) {
  const std::string twice = GetParam() + "," + GetParam();
  const auto queues_of = [&](int n_queues) {
    std::vector<std::size_t> queues;
    for (const Context& context : open_contexts(twice, n_queues)) queues.push_back(context.queues().size());
    return queues;
  };
  EXPECT_EQ(queues_of(1), (std::vector<std::size_t>{1, 1}));
  EXPECT_EQ(queues_of(2), (std::vector<std::size_t>{1, 1}));
  EXPECT_EQ(queues_of(5), (std::vector<std::size_t>{3, 2}));
  EXPECT_EQ(open_contexts(GetParam(), 2).size(), 1u);
}

TEST_P(ContextTest, AHoleInTheListOfDevicesIsAnError) {
  for (const std::string& specs : {GetParam() + ",", "," + GetParam(), GetParam() + ",," + GetParam()}) {
    try {
      (void)open_contexts(specs, 1);
      FAIL() << specs;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
}

// What a command's times say lies between asking for it and seeing its end.
TEST_P(ContextTest, AClockBringsTimesToTheHost) {
  const Context context(GetParam(), 1);
  cl::CommandQueue queue = context.queues().front();
  const cl::Buffer buffer = context.buffer(CL_MEM_READ_WRITE, 1 << 20, "a test");
  const std::vector<char> bytes(1 << 20);
  // A clock is as far off as the machine was busy when it was set.
  const auto is_right = [&](const Clock& clock) {
    constexpr std::chrono::milliseconds kError{20};
    cl::Event event;
    const auto before = Clock::Host::now();
    queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes.size(), bytes.data(), nullptr, &event);
    const auto after = Clock::Host::now();
    event.wait();  // see clock.cpp
    const auto moment = [&](auto time) { return clock.on_host(1e-9 * static_cast<double>(time)); };
    const auto start = moment(event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
    const auto end = moment(event.getProfilingInfo<CL_PROFILING_COMMAND_END>());
    EXPECT_LE(start, end);
    return start >= before - kError && end <= after + kError;
  };
  EXPECT_TRUE(test::comes_true([&] {
    const Clock clock(context.get(), queue);
    return is_right(clock) && is_right(clock) && is_right(clock);
  }));
}

TEST_P(ContextTest, RefusesABufferLargerThanTheDeviceAllows) {
  const Context context(GetParam(), 1);
  try {
    (void)context.buffer(CL_MEM_READ_WRITE, context.info().max_allocation + 1, "a test");
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::out_of_memory);
    EXPECT_NE(std::string(error.what()).find("a test"), std::string::npos) << error.what();
  }
}

TEST_P(ContextTest, AnEmptyBufferIsNoError) {
  const Context context(GetParam(), 1);
  EXPECT_NO_THROW((void)context.buffer(CL_MEM_READ_ONLY, 0, "nothing"));
}

// Where the device works in the host's memory, a buffer is the memory itself, and keeps it; elsewhere a copy
// of it.
TEST_P(ContextTest, UploadedMemoryIsUsedAsItIsOrCopied) {
  const Context context(GetParam(), 1);
  for (const std::size_t n : {std::size_t{3}, kLargePages / 4}) {
    auto values = std::make_shared<std::vector<std::uint32_t>>(n);
    std::iota(values->begin(), values->end(), 7u);
    const std::weak_ptr<void> watched = values;
    const void* const data = values->data();
    cl::Buffer buffer = context.upload(data, 4 * n, std::move(values), "a test");
    std::vector<std::uint32_t> back(n);
    context.queues().front().enqueueReadBuffer(buffer, CL_TRUE, 0, 4 * n, back.data());
    EXPECT_EQ(back.front(), 7u);
    EXPECT_EQ(back.back(), 6 + n);
    EXPECT_EQ(watched.expired(), buffer.getInfo<CL_MEM_HOST_PTR>() != data);
    if (context.info().kind == "cpu") {
      EXPECT_FALSE(watched.expired());
    }
    context.queues().front().finish();
    buffer = {};
    EXPECT_TRUE(watched.expired());
  }
}

TEST_P(ContextTest, NothingCanBeUploaded) {
  const Context context(GetParam(), 1);
  EXPECT_NO_THROW((void)context.upload(nullptr, 0, nullptr, "nothing"));
}

KDRAY_FOR_EACH_DEVICE(ContextTest);

TEST(ChooseDevice, NamesWhatThereIsWhenThereIsNoSuchDevice) {
  try {
    (void)choose_device("no such device");
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::no_device);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(OpenClError, NamesCallAndCode) {
  const Error error = translate(cl::Error(CL_INVALID_KERNEL_ARGS, "clEnqueueNDRangeKernel"), "rendering");
  EXPECT_EQ(error.code(), ErrorCode::internal);
  EXPECT_NE(std::string(error.what()).find("rendering: clEnqueueNDRangeKernel gave CL_INVALID_KERNEL_ARGS"),
            std::string::npos)
      << error.what();
  EXPECT_EQ(translate(cl::Error(CL_MEM_OBJECT_ALLOCATION_FAILURE, "x"), "y").code(),
            ErrorCode::out_of_memory);
  EXPECT_EQ(code_name(-4242), "OpenCL error -4242");
}

}  // namespace
}  // namespace kdray::device
