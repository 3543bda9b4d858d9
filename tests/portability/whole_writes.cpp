// What    Loaded before kdray (LD_PRELOAD) where Oclgrind looks for uninitialised reads: writes and fills of
//         a part of a buffer are made writes of the whole, with what the rest holds.
// Why     Oclgrind 21.10 gives a buffer new shadow memory at each write by the host, as large as that write
//         (Uninitialized::hostMemoryStore). What lies behind it counts as uninitialised from then on,
//         whatever kernels store there; and a fill is a row of writes of one pattern each
//         (docs/design/portability.md). So a buffer that the host writes a part of counts as initialised:
//         there the check is blind.
#include <dlfcn.h>

#include <cstring>
#include <vector>

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace {

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// The buffer's bytes once these commands have ended; empty where they can't be had.
std::vector<unsigned char> bytes_of(cl_command_queue queue, cl_mem buffer, cl_uint n, const cl_event* waits) {
  std::size_t size = 0;
  if (clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof size, &size, nullptr) != CL_SUCCESS) return {};
  std::vector<unsigned char> bytes(size);
  if (clEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, size, bytes.data(), n, waits, nullptr) != CL_SUCCESS)
    return {};
  return bytes;
}

cl_int write(cl_command_queue queue, cl_mem buffer, const std::vector<unsigned char>& bytes,
             cl_event* event) {
  static auto* const next = real<decltype(clEnqueueWriteBuffer)>("clEnqueueWriteBuffer");
  return next(queue, buffer, CL_TRUE, 0, bytes.size(), bytes.data(), 0, nullptr, event);
}

}  // namespace

extern "C" cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer, cl_bool, std::size_t offset,
                                       std::size_t size, const void* data, cl_uint n, const cl_event* waits,
                                       cl_event* event) {
  std::vector<unsigned char> bytes = bytes_of(queue, buffer, n, waits);
  if (offset > bytes.size() || size > bytes.size() - offset) return CL_INVALID_VALUE;
  std::memcpy(bytes.data() + offset, data, size);
  return write(queue, buffer, bytes, event);
}

extern "C" cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer, const void* pattern,
                                      std::size_t pattern_size, std::size_t offset, std::size_t size,
                                      cl_uint n, const cl_event* waits, cl_event* event) {
  std::vector<unsigned char> bytes = bytes_of(queue, buffer, n, waits);
  if (pattern_size == 0 || offset > bytes.size() || size > bytes.size() - offset) return CL_INVALID_VALUE;
  for (std::size_t at = 0; at + pattern_size <= size; at += pattern_size)
    std::memcpy(bytes.data() + offset + at, pattern, pattern_size);
  return write(queue, buffer, bytes, event);
}
