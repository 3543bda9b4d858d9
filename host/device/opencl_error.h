// What    Turns OpenCL's errors into kdray's: the name of the call and of the code, out of memory told apart.
#pragma once

#include <string>

#include "base/error.h"
#include "device/opencl.h"

namespace kdray::device {

// "CL_OUT_OF_RESOURCES" for -5; "OpenCL error -1234" for what has no name.
std::string code_name(cl_int code);

// `doing` says what kdray was about to do ("uploading the scene").
[[nodiscard]] Error translate(const cl::Error& error, const std::string& doing);

// Runs `call` and lets cl::Error leave as kdray::Error.
template <class Call>
decltype(auto) checked(const std::string& doing, Call&& call) {
  try {
    return call();
  } catch (const cl::Error& error) {
    throw translate(error, doing);
  }
}

}  // namespace kdray::device
