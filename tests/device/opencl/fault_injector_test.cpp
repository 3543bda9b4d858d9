// What    Faults on purpose: the launches that are named fail, and no other.
#include "device/opencl/fault_injector.h"

#include <gtest/gtest.h>

#include "device/opencl/opencl.h"
#include "kdray/error.h"
#include "support/errors.h"

namespace kdray::test {
namespace {

using device::FaultInjector;

TEST(FaultInjector, NamedLaunchesFail) {
  FaultInjector injector("1@2,0@1,1@3");
  EXPECT_THROW(injector.launch(0), cl::Error);
  EXPECT_NO_THROW(injector.launch(0));
  EXPECT_NO_THROW(injector.launch(1));
  EXPECT_THROW(injector.launch(1), cl::Error);
  EXPECT_THROW(injector.launch(1), cl::Error);
  EXPECT_NO_THROW(injector.launch(1));
  EXPECT_NO_THROW(injector.launch(7));
}

TEST(FaultInjector, FailInTheWayThatIsAskedFor) {
  FaultInjector injector("0@1:device,0@2:memory,0@3:bug,0@4:input,1@1");
  const auto code_of_next = [&](std::size_t queue) -> cl_int {
    try {
      injector.launch(queue);
    } catch (const cl::Error& error) {
      return error.err();
    }
    return CL_SUCCESS;
  };
  EXPECT_EQ(code_of_next(0), CL_OUT_OF_RESOURCES);
  EXPECT_EQ(code_of_next(0), CL_MEM_OBJECT_ALLOCATION_FAILURE);
  EXPECT_EQ(code_of_next(0), CL_INVALID_KERNEL_ARGS);
  EXPECT_TRUE(fails([&] { injector.launch(0); }, "fault on purpose"));
  EXPECT_EQ(code_of_next(1), CL_OUT_OF_RESOURCES);
}

TEST(FaultInjector, NamedDevicesFailTheSelfTest) {
  const FaultInjector injector("self-test@1,0@1,self-test@3");
  for (int device = 0; device < 5; ++device)
    EXPECT_EQ(injector.fails_self_test(device), device == 1 || device == 3) << device;
  EXPECT_FALSE(FaultInjector().fails_self_test(0));
}

TEST(FaultInjector, NoneByDefault) {
  FaultInjector injector;
  for (int i = 0; i < 10; ++i) EXPECT_NO_THROW(injector.launch(0));
}

TEST(FaultInjector, WhatNamesNoFaultIsRefused) {
  for (const char* const text :
       {"1", "@", "1@", "@1", "1@0", "a@1", "1@2x", "1@1,,2@2", "-1@2", "self-test", "self-test@",
        "self-test@x", "self@1", "1@2:", "1@2:none", "1@2:bug:bug", "1:bug@2", "self-test@1:bug"}) {
    try {
      FaultInjector injector(text);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::usage) << text;
    }
  }
}

}  // namespace
}  // namespace kdray::test
