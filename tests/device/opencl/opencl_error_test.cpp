// What    Whose fault a code of OpenCL's is: what the user is told, and whether other queues may take over.
#include "device/opencl/opencl_error.h"

#include <gtest/gtest.h>

#include <new>
#include <string>

#include "support/errors.h"

namespace kdray::test {
namespace {

using device::error_of_queue;
using device::Fault;

std::exception_ptr gives(cl_int code) {
  return std::make_exception_ptr(cl::Error(code, "clCall"));
}

Error told(cl_int code) {
  return device::translate(cl::Error(code, "clCall"), "rendering");
}

TEST(OpenclError, EveryInvalidArgumentIsABug) {
  constexpr cl_int kLastOfThree = -72;  // CL_MAX_SIZE_RESTRICTION_EXCEEDED of OpenCL 3.0
  for (cl_int code = kLastOfThree; code <= CL_INVALID_VALUE; ++code) {
    if (code == CL_INVALID_COMMAND_QUEUE || code == CL_INVALID_BUFFER_SIZE) continue;
    EXPECT_EQ(device::fault_of(code), Fault::bug) << device::code_name(code);
    EXPECT_NE(device::code_name(code).find("CL_"), std::string::npos) << code;
  }
}

TEST(OpenclError, ADeviceThatIsLostIsNotABug) {
  for (const cl_int code : {CL_DEVICE_NOT_AVAILABLE, CL_OUT_OF_RESOURCES, CL_INVALID_COMMAND_QUEUE,
                            CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST, CL_COMPILER_NOT_AVAILABLE, -1234})
    EXPECT_EQ(told(code).code(), ErrorCode::no_device) << device::code_name(code);
}

TEST(OpenclError, MemoryIsToldAsMemory) {
  for (const cl_int code : {CL_MEM_OBJECT_ALLOCATION_FAILURE, CL_OUT_OF_HOST_MEMORY, CL_INVALID_BUFFER_SIZE})
    EXPECT_EQ(told(code).code(), ErrorCode::out_of_memory) << device::code_name(code);
}

TEST(OpenclError, ABugIsToldAsKdraysAndNotAsAMissingDevice) {
  const Error error = told(CL_INVALID_KERNEL_ARGS);
  const std::string text = error.what();
  EXPECT_EQ(error.code(), ErrorCode::internal);
  EXPECT_NE(text.find("rendering: clCall gave CL_INVALID_KERNEL_ARGS"), std::string::npos) << text;
  EXPECT_NE(text.find("a fault of kdray, please report"), std::string::npos) << text;
  EXPECT_EQ(text.find("doctor"), std::string::npos) << text;
}

TEST(OpenclError, OtherQueuesTakeOverFromADeviceAndFromTooLittleMemory) {
  const Error device = error_of_queue(gives(CL_OUT_OF_RESOURCES), "rendering");
  EXPECT_EQ(device.code(), ErrorCode::no_device);
  EXPECT_NE(std::string(device.what()).find("rendering: clCall"), std::string::npos) << device.what();
  EXPECT_EQ(error_of_queue(gives(CL_OUT_OF_HOST_MEMORY), "rendering").code(), ErrorCode::out_of_memory);
  const Error own(ErrorCode::no_device, "computes wrongly");
  EXPECT_STREQ(error_of_queue(std::make_exception_ptr(own), "rendering").what(), "computes wrongly");
}

TEST(OpenclError, NoQueueTakesOverFromABugOrAnErrorOfTheInput) {
  EXPECT_TRUE(fails([] { (void)error_of_queue(gives(CL_INVALID_ARG_SIZE), "rendering"); },
                    "CL_INVALID_ARG_SIZE", ErrorCode::internal));
  for (const ErrorCode code : {ErrorCode::input, ErrorCode::usage, ErrorCode::internal})
    EXPECT_TRUE(fails([&] { (void)error_of_queue(std::make_exception_ptr(Error(code, "own")), "rendering"); },
                      "own", code));
  EXPECT_THROW((void)error_of_queue(std::make_exception_ptr(std::bad_alloc()), "rendering"), std::bad_alloc);
}

}  // namespace
}  // namespace kdray::test
