// What    An OpenCL driver that goes wrong, as a library for the loader: a platform with one GPU, which kdray
//         would prefer to every CPU.
// Shape   FAKE_DRIVER says how it goes wrong: "WHAT-WHERE", WHAT being hang, crash, abort, exit or refuse (an
//         error of OpenCL's, with more than a line of text to it), WHERE load (of the library), list (of
//         the devices) or build (of a program). Whatever it is asked for is noted in the file
//         FAKE_DRIVER_LOG, a line each: where, and the process.
#include <CL/cl_icd.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

std::string variable(const char* name, const char* otherwise) {
  const char* const value = std::getenv(name);
  return value ? value : otherwise;
}

void note(const std::string& where) {
  std::FILE* const log = std::fopen(variable("FAKE_DRIVER_LOG", "/dev/null").c_str(), "a");
  if (!log) return;
  std::fputs((where + " " + std::to_string(::getpid()) + "\n").c_str(), log);
  std::fclose(log);
}

int* const nowhere = nullptr;

// Whether it goes on at all: false where it is to refuse.
bool survives(const std::string& where) {
  note(where);
  const std::string wrong = variable("FAKE_DRIVER", "");
  if (!wrong.ends_with("-" + where)) return true;
  const std::string what = wrong.substr(0, wrong.find('-'));
  if (what == "hang")
    while (true) ::pause();
  if (what == "crash") *const_cast<volatile int*>(nowhere) = 1;
  if (what == "abort") std::abort();
  if (what == "exit") std::exit(1);
  return false;
}

struct Loaded {
  Loaded() { survives("load"); }
} loaded;

// What every object of OpenCL begins with: the functions that the loader calls for it.
extern cl_icd_dispatch functions;

// There is one of each.
template <class Handle>
Handle the_one() {
  static struct { const cl_icd_dispatch* dispatch = &functions; } object;
  return reinterpret_cast<Handle>(&object);
}

cl_int give(const void* value, std::size_t bytes, std::size_t size, void* to, std::size_t* size_ret) {
  if (size_ret) *size_ret = bytes;
  if (!to) return CL_SUCCESS;
  if (size < bytes) return CL_INVALID_VALUE;
  std::memcpy(to, value, bytes);
  return CL_SUCCESS;
}

cl_int give(const std::string& text, std::size_t size, void* to, std::size_t* size_ret) {
  return give(text.c_str(), text.size() + 1, size, to, size_ret);
}

template <class Value>
cl_int give_value(Value value, std::size_t size, void* to, std::size_t* size_ret) {
  return give(&value, sizeof value, size, to, size_ret);
}

cl_int get_platform_ids(cl_uint n, cl_platform_id* platforms, cl_uint* found) {
  if (found) *found = 1;
  if (platforms && n > 0) platforms[0] = the_one<cl_platform_id>();
  return CL_SUCCESS;
}

cl_int get_platform_info(cl_platform_id, cl_platform_info what, std::size_t size, void* to, std::size_t* n) {
  switch (what) {
    case CL_PLATFORM_NAME:
      return give("Fake", size, to, n);
    case CL_PLATFORM_VERSION:
      return give("OpenCL 1.2 fake", size, to, n);
    case CL_PLATFORM_EXTENSIONS:
      return give("cl_khr_icd", size, to, n);
    case CL_PLATFORM_PROFILE:
      return give("FULL_PROFILE", size, to, n);
    case CL_PLATFORM_VENDOR:
    case CL_PLATFORM_ICD_SUFFIX_KHR:
      return give("FAKE", size, to, n);
    default:
      return CL_INVALID_VALUE;
  }
}

cl_int get_device_ids(cl_platform_id, cl_device_type, cl_uint n, cl_device_id* devices, cl_uint* found) {
  if (!survives("list")) return CL_DEVICE_NOT_FOUND;
  if (found) *found = 1;
  if (devices && n > 0) devices[0] = the_one<cl_device_id>();
  return CL_SUCCESS;
}

cl_int get_device_info(cl_device_id, cl_device_info what, std::size_t size, void* to, std::size_t* n) {
  switch (what) {
    case CL_DEVICE_NAME:
      return give("Fake device", size, to, n);
    case CL_DEVICE_VENDOR:
      return give("FAKE", size, to, n);
    case CL_DEVICE_VERSION:
      return give("OpenCL 1.2 fake", size, to, n);
    case CL_DEVICE_OPENCL_C_VERSION:
      return give("OpenCL C 1.2", size, to, n);
    case CL_DRIVER_VERSION:
      return give(variable("FAKE_DRIVER_VERSION", "1"), size, to, n);
    case CL_DEVICE_EXTENSIONS:
      return give("", size, to, n);
    case CL_DEVICE_TYPE:
      return give_value<cl_device_type>(CL_DEVICE_TYPE_GPU, size, to, n);
    case CL_DEVICE_PLATFORM:
      return give_value(the_one<cl_platform_id>(), size, to, n);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
      return give_value<cl_uint>(64, size, to, n);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
      return give_value<cl_ulong>(cl_ulong{1} << 34, size, to, n);
    case CL_DEVICE_SINGLE_FP_CONFIG:
      return give_value<cl_device_fp_config>(CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST, size, to, n);
    case CL_DEVICE_DOUBLE_FP_CONFIG:
      return give_value<cl_device_fp_config>(0, size, to, n);
    case CL_DEVICE_AVAILABLE:
    case CL_DEVICE_COMPILER_AVAILABLE:
    case CL_DEVICE_ENDIAN_LITTLE:
      return give_value<cl_bool>(CL_TRUE, size, to, n);
    default:
      return CL_INVALID_VALUE;
  }
}

cl_int build_program(cl_program, cl_uint, const cl_device_id*, const char*, void (*)(cl_program, void*),
                     void*) {
  return survives("build") ? CL_SUCCESS : CL_BUILD_PROGRAM_FAILURE;
}

cl_int get_program_info(cl_program, cl_program_info what, std::size_t size, void* to, std::size_t* n) {
  switch (what) {
    case CL_PROGRAM_NUM_DEVICES:
      return give_value<cl_uint>(1, size, to, n);
    case CL_PROGRAM_DEVICES:
      return give_value(the_one<cl_device_id>(), size, to, n);
    default:
      return CL_INVALID_VALUE;
  }
}

cl_int get_build_info(cl_program, cl_device_id, cl_program_build_info what, std::size_t size, void* to,
                      std::size_t* n) {
  if (what != CL_PROGRAM_BUILD_LOG) return CL_INVALID_VALUE;
  return give("1 error found\nfake.cl:1: error: no such thing\nand more", size, to, n);
}

template <class Handle>
cl_int keep(Handle) {
  return CL_SUCCESS;
}

template <class Handle>
Handle make(cl_int* error) {
  if (error) *error = CL_SUCCESS;
  return the_one<Handle>();
}

// There are no kernels: a program that "builds" is of no use.
cl_kernel no_kernel(cl_program, const char*, cl_int* error) {
  if (error) *error = CL_OUT_OF_RESOURCES;
  return nullptr;
}

cl_icd_dispatch all_functions() {
  cl_icd_dispatch f{};
  f.clGetPlatformIDs = get_platform_ids;
  f.clGetPlatformInfo = get_platform_info;
  f.clGetDeviceIDs = get_device_ids;
  f.clGetDeviceInfo = get_device_info;
  f.clRetainDevice = keep<cl_device_id>;
  f.clReleaseDevice = keep<cl_device_id>;
  f.clCreateContext = [](const cl_context_properties*, cl_uint, const cl_device_id*,
                         void (*)(const char*, const void*, std::size_t, void*), void*,
                         cl_int* error) { return make<cl_context>(error); };
  f.clRetainContext = keep<cl_context>;
  f.clReleaseContext = keep<cl_context>;
  f.clCreateCommandQueue = [](cl_context, cl_device_id, cl_command_queue_properties, cl_int* error) {
    return make<cl_command_queue>(error);
  };
  f.clRetainCommandQueue = keep<cl_command_queue>;
  f.clReleaseCommandQueue = keep<cl_command_queue>;
  f.clCreateProgramWithSource = [](cl_context, cl_uint, const char**, const std::size_t*, cl_int* error) {
    return make<cl_program>(error);
  };
  f.clRetainProgram = keep<cl_program>;
  f.clReleaseProgram = keep<cl_program>;
  f.clBuildProgram = build_program;
  f.clGetProgramInfo = get_program_info;
  f.clGetProgramBuildInfo = get_build_info;
  f.clCreateKernel = no_kernel;
  return f;
}

cl_icd_dispatch functions = all_functions();

}  // namespace

// What the loader looks for in the library.
extern "C" cl_int clIcdGetPlatformIDsKHR(cl_uint n, cl_platform_id* platforms, cl_uint* found) {
  return get_platform_ids(n, platforms, found);
}

extern "C" cl_int clGetPlatformInfo(cl_platform_id platform, cl_platform_info what, std::size_t size,
                                    void* to, std::size_t* n) {
  return get_platform_info(platform, what, size, to, n);
}

extern "C" void* clGetExtensionFunctionAddress(const char* name) {
  if (std::strcmp(name, "clIcdGetPlatformIDsKHR") == 0)
    return reinterpret_cast<void*>(&clIcdGetPlatformIDsKHR);
  return nullptr;
}
