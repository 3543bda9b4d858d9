#include "device/opencl_error.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace kdray::device {

namespace {

struct Code {
  cl_int code;
  const char* name;
};

constexpr std::array kCodes = {
    Code{-1, "CL_DEVICE_NOT_FOUND"},
    Code{-2, "CL_DEVICE_NOT_AVAILABLE"},
    Code{-3, "CL_COMPILER_NOT_AVAILABLE"},
    Code{-4, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
    Code{-5, "CL_OUT_OF_RESOURCES"},
    Code{-6, "CL_OUT_OF_HOST_MEMORY"},
    Code{-9, "CL_IMAGE_FORMAT_MISMATCH"},
    Code{-11, "CL_BUILD_PROGRAM_FAILURE"},
    Code{-12, "CL_MAP_FAILURE"},
    Code{-13, "CL_MISALIGNED_SUB_BUFFER_OFFSET"},
    Code{-14, "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
    Code{-15, "CL_COMPILE_PROGRAM_FAILURE"},
    Code{-17, "CL_LINK_PROGRAM_FAILURE"},
    Code{-18, "CL_DEVICE_PARTITION_FAILED"},
    Code{-30, "CL_INVALID_VALUE"},
    Code{-32, "CL_INVALID_PLATFORM"},
    Code{-33, "CL_INVALID_DEVICE"},
    Code{-34, "CL_INVALID_CONTEXT"},
    Code{-36, "CL_INVALID_COMMAND_QUEUE"},
    Code{-37, "CL_INVALID_HOST_PTR"},
    Code{-38, "CL_INVALID_MEM_OBJECT"},
    Code{-42, "CL_INVALID_BINARY"},
    Code{-43, "CL_INVALID_BUILD_OPTIONS"},
    Code{-44, "CL_INVALID_PROGRAM"},
    Code{-45, "CL_INVALID_PROGRAM_EXECUTABLE"},
    Code{-46, "CL_INVALID_KERNEL_NAME"},
    Code{-48, "CL_INVALID_KERNEL"},
    Code{-49, "CL_INVALID_ARG_INDEX"},
    Code{-50, "CL_INVALID_ARG_VALUE"},
    Code{-51, "CL_INVALID_ARG_SIZE"},
    Code{-52, "CL_INVALID_KERNEL_ARGS"},
    Code{-53, "CL_INVALID_WORK_DIMENSION"},
    Code{-54, "CL_INVALID_WORK_GROUP_SIZE"},
    Code{-55, "CL_INVALID_WORK_ITEM_SIZE"},
    Code{-57, "CL_INVALID_EVENT_WAIT_LIST"},
    Code{-59, "CL_INVALID_OPERATION"},
    Code{-61, "CL_INVALID_BUFFER_SIZE"},
    Code{-63, "CL_INVALID_GLOBAL_WORK_SIZE"},
    Code{-68, "CL_INVALID_DEVICE_PARTITION_COUNT"},
    Code{-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
};

bool is_out_of_memory(cl_int code) {
  return code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_HOST_MEMORY ||
         code == CL_INVALID_BUFFER_SIZE;
}

}  // namespace

std::string code_name(cl_int code) {
  for (const Code& c : kCodes)
    if (c.code == code) return c.name;
  return fmt::format("OpenCL error {}", code);
}

Error translate(const cl::Error& error, const std::string& doing) {
  const std::string text = fmt::format("{}: {} gave {}", doing, error.what(), code_name(error.err()));
  if (is_out_of_memory(error.err()))
    return Error(ErrorCode::out_of_memory,
                 text + "; the device's memory does not suffice, see `kdray devices`");
  return Error(ErrorCode::no_device, text + "; `kdray doctor` checks the device");
}

}  // namespace kdray::device
