#include "device/host_memory.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace kdray::device {

namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;

// Pages are taken in whole large ones; the hint may be refused, and small ones do as well.
void* allocate(std::size_t bytes) {
  const std::size_t whole = (bytes + kPage - 1) / kPage * kPage;
  void* const memory = std::aligned_alloc(kPage, whole);
  if (memory == nullptr) throw std::bad_alloc();
  madvise(memory, whole, MADV_HUGEPAGE);
  return memory;
}

void CL_CALLBACK release(cl_mem, void* memory) {
  std::free(memory);
}

}  // namespace

cl::Buffer host_buffer(const cl::Context& context, cl_mem_flags flags, std::size_t bytes) {
  void* const memory = allocate(bytes);
  try {
    cl::Buffer buffer(context, flags | CL_MEM_USE_HOST_PTR, bytes, memory);
    buffer.setDestructorCallback(release, memory);
    return buffer;
  } catch (...) {
    std::free(memory);
    throw;
  }
}

}  // namespace kdray::device
