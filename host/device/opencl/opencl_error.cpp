#include "device/opencl/opencl_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace kdray::device {

namespace {

struct Code {
  cl_int code;
  const char* name;
  Fault fault;
};

// All codes of OpenCL 3.0, and those of extensions that drivers are known to give.
constexpr std::array kCodes = {
    Code{-1, "CL_DEVICE_NOT_FOUND", Fault::device},
    Code{-2, "CL_DEVICE_NOT_AVAILABLE", Fault::device},
    Code{-3, "CL_COMPILER_NOT_AVAILABLE", Fault::device},
    Code{-4, "CL_MEM_OBJECT_ALLOCATION_FAILURE", Fault::memory},
    Code{-5, "CL_OUT_OF_RESOURCES", Fault::device},
    Code{-6, "CL_OUT_OF_HOST_MEMORY", Fault::memory},
    Code{-7, "CL_PROFILING_INFO_NOT_AVAILABLE", Fault::bug},
    Code{-8, "CL_MEM_COPY_OVERLAP", Fault::bug},
    Code{-9, "CL_IMAGE_FORMAT_MISMATCH", Fault::bug},
    Code{-10, "CL_IMAGE_FORMAT_NOT_SUPPORTED", Fault::bug},
    Code{-11, "CL_BUILD_PROGRAM_FAILURE", Fault::device},
    Code{-12, "CL_MAP_FAILURE", Fault::device},
    Code{-13, "CL_MISALIGNED_SUB_BUFFER_OFFSET", Fault::bug},
    Code{-14, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST", Fault::device},
    Code{-15, "CL_COMPILE_PROGRAM_FAILURE", Fault::device},
    Code{-16, "CL_LINKER_NOT_AVAILABLE", Fault::device},
    Code{-17, "CL_LINK_PROGRAM_FAILURE", Fault::device},
    Code{-18, "CL_DEVICE_PARTITION_FAILED", Fault::device},
    Code{-19, "CL_KERNEL_ARG_INFO_NOT_AVAILABLE", Fault::bug},
    Code{-30, "CL_INVALID_VALUE", Fault::bug},
    Code{-31, "CL_INVALID_DEVICE_TYPE", Fault::bug},
    Code{-32, "CL_INVALID_PLATFORM", Fault::bug},
    Code{-33, "CL_INVALID_DEVICE", Fault::bug},
    Code{-34, "CL_INVALID_CONTEXT", Fault::bug},
    Code{-35, "CL_INVALID_QUEUE_PROPERTIES", Fault::bug},
    // Queues are open until the process ends (context.h): one becomes invalid only when its device is lost,
    // which is what NVIDIA's driver says of a queue whose kernel was stopped.
    Code{-36, "CL_INVALID_COMMAND_QUEUE", Fault::device},
    Code{-37, "CL_INVALID_HOST_PTR", Fault::bug},
    Code{-38, "CL_INVALID_MEM_OBJECT", Fault::bug},
    Code{-39, "CL_INVALID_IMAGE_FORMAT_DESCRIPTOR", Fault::bug},
    Code{-40, "CL_INVALID_IMAGE_SIZE", Fault::bug},
    Code{-41, "CL_INVALID_SAMPLER", Fault::bug},
    Code{-42, "CL_INVALID_BINARY", Fault::bug},
    Code{-43, "CL_INVALID_BUILD_OPTIONS", Fault::bug},
    Code{-44, "CL_INVALID_PROGRAM", Fault::bug},
    Code{-45, "CL_INVALID_PROGRAM_EXECUTABLE", Fault::bug},
    Code{-46, "CL_INVALID_KERNEL_NAME", Fault::bug},
    Code{-47, "CL_INVALID_KERNEL_DEFINITION", Fault::bug},
    Code{-48, "CL_INVALID_KERNEL", Fault::bug},
    Code{-49, "CL_INVALID_ARG_INDEX", Fault::bug},
    Code{-50, "CL_INVALID_ARG_VALUE", Fault::bug},
    Code{-51, "CL_INVALID_ARG_SIZE", Fault::bug},
    Code{-52, "CL_INVALID_KERNEL_ARGS", Fault::bug},
    Code{-53, "CL_INVALID_WORK_DIMENSION", Fault::bug},
    Code{-54, "CL_INVALID_WORK_GROUP_SIZE", Fault::bug},
    Code{-55, "CL_INVALID_WORK_ITEM_SIZE", Fault::bug},
    Code{-56, "CL_INVALID_GLOBAL_OFFSET", Fault::bug},
    Code{-57, "CL_INVALID_EVENT_WAIT_LIST", Fault::bug},
    Code{-58, "CL_INVALID_EVENT", Fault::bug},
    Code{-59, "CL_INVALID_OPERATION", Fault::bug},
    Code{-60, "CL_INVALID_GL_OBJECT", Fault::bug},
    // No buffer is made of 0 bytes (context.cpp), so that this one is larger than the device takes.
    Code{-61, "CL_INVALID_BUFFER_SIZE", Fault::memory},
    Code{-62, "CL_INVALID_MIP_LEVEL", Fault::bug},
    Code{-63, "CL_INVALID_GLOBAL_WORK_SIZE", Fault::bug},
    Code{-64, "CL_INVALID_PROPERTY", Fault::bug},
    Code{-65, "CL_INVALID_IMAGE_DESCRIPTOR", Fault::bug},
    Code{-66, "CL_INVALID_COMPILER_OPTIONS", Fault::bug},
    Code{-67, "CL_INVALID_LINKER_OPTIONS", Fault::bug},
    Code{-68, "CL_INVALID_DEVICE_PARTITION_COUNT", Fault::bug},
    Code{-69, "CL_INVALID_PIPE_SIZE", Fault::bug},
    Code{-70, "CL_INVALID_DEVICE_QUEUE", Fault::bug},
    Code{-71, "CL_INVALID_SPEC_ID", Fault::bug},
    Code{-72, "CL_MAX_SIZE_RESTRICTION_EXCEEDED", Fault::bug},
    Code{-1001, "CL_PLATFORM_NOT_FOUND_KHR", Fault::device},
    // NVIDIA's word for a kernel that reads or writes beyond its buffers.
    Code{-9999, "an illegal read or write to a buffer (-9999)", Fault::bug},
};

const Code* find(cl_int code) {
  const auto found =
      std::find_if(kCodes.begin(), kCodes.end(), [code](const Code& c) { return c.code == code; });
  return found == kCodes.end() ? nullptr : &*found;
}

bool others_may_take_over(const Error& error) {
  return error.code() == ErrorCode::no_device || error.code() == ErrorCode::out_of_memory;
}

}  // namespace

Fault fault_of(cl_int code) {
  const Code* const known = find(code);
  return known ? known->fault : Fault::device;
}

std::string code_name(cl_int code) {
  const Code* const known = find(code);
  return known ? known->name : fmt::format("OpenCL error {}", code);
}

Error translate(const cl::Error& error, const std::string& doing) {
  const std::string text = fmt::format("{}: {} gave {}", doing, error.what(), code_name(error.err()));
  switch (fault_of(error.err())) {
    case Fault::memory:
      return Error(ErrorCode::out_of_memory,
                   text + "; the device's memory does not suffice, see `kdray devices`");
    case Fault::bug:
      return Error(
          ErrorCode::internal,
          text +
              "; this is a fault of kdray, please report this line with the command, the scene and what "
              "`kdray devices` prints");
    case Fault::device:
      break;
  }
  return Error(ErrorCode::no_device, text + "; `kdray doctor` checks the device");
}

Error error_of_queue(const std::exception_ptr& thrown, const std::string& doing) {
  try {
    std::rethrow_exception(thrown);
  } catch (const cl::Error& error) {
    const Error judged = translate(error, doing);
    if (!others_may_take_over(judged)) throw judged;
    return judged;
  } catch (const Error& error) {
    if (!others_may_take_over(error)) throw;
    return error;
  }
}

}  // namespace kdray::device
