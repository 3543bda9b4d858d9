// What    Judges OpenCL's errors, in one place for whoever calls OpenCL: whose fault a code is, what the user
//         is told, and whether other queues may take over from the one that it came from.
// Why     A queue whose device fails is left out, and the picture is still right. A bug would happen again on
//         the next queue, and reported as a missing device it would send the user looking for a driver.
#pragma once

#include <exception>
#include <string>

#include "base/error.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

enum class Fault {
  device,  // the device or its driver: ErrorCode::no_device
  memory,  // too little of it, the device's or the machine's: ErrorCode::out_of_memory
  bug      // kdray has called OpenCL wrongly: ErrorCode::internal
};

// A code that has no name is some driver's own, and counts as the device's.
Fault fault_of(cl_int code);

// Returns "CL_OUT_OF_RESOURCES" for -5; "OpenCL error -1234" for what has no name.
std::string code_name(cl_int code);

// Returns the error for the user; `doing` says what kdray was about to do ("uploading the scene").
[[nodiscard]] Error translate(const cl::Error& error, const std::string& doing);

// Judges what ended a queue's work, in every mode. Returns the error where the device is at fault or has too
// little memory: other queues may take over, with a warning. Everything else is thrown on and ends the run.
[[nodiscard]] Error error_of_queue(const std::exception_ptr& thrown, const std::string& doing);

// Runs `call` and turns cl::Error into kdray::Error.
template <class Call>
decltype(auto) checked(const std::string& doing, Call&& call) {
  try {
    return call();
  } catch (const cl::Error& error) {
    throw translate(error, doing);
  }
}

}  // namespace kdray::device
