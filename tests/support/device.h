// What    Every usable OpenCL device, for tests that run on each of them; without one they skip, saying so.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "device/opencl/platform.h"

namespace kdray::test {

inline std::vector<std::string> usable_devices() {
  std::vector<std::string> numbers;
  for (const device::FoundDevice& found : device::find_devices())
    if (found.info.usable) numbers.push_back(std::to_string(found.info.number));
  return numbers;
}

inline bool computes_in_double(const std::string& number) {
  for (const device::FoundDevice& found : device::find_devices())
    if (std::to_string(found.info.number) == number) return found.info.double_precision;
  return false;
}

// A fixture whose cases take a device's number (DeviceOptions::device, --device).
class EachDevice : public testing::TestWithParam<std::string> {};

}  // namespace kdray::test

// Instantiates the fixture once per device. Without a device the suite is empty, which gtest is told is no
// error.
#define KDRAY_FOR_EACH_DEVICE(Fixture)                    \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Fixture); \
  INSTANTIATE_TEST_SUITE_P(Device, Fixture, testing::ValuesIn(kdray::test::usable_devices()))
