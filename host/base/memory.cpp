#include "base/memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace kdray {

namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
constexpr std::size_t kAlignment = 128;  // the widest vector of OpenCL: long16

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

}  // namespace

// Large pages are taken whole; the hint may be refused, and small ones do as well.
void* allocate_pages(std::size_t bytes) {
  const bool large = bytes >= kLargePages;
  const std::size_t alignment = large ? kPage : kAlignment;
  const std::size_t whole = rounded_up(bytes, alignment);
  if (whole < bytes) throw std::bad_alloc();
  void* const memory = std::aligned_alloc(alignment, whole);
  if (memory == nullptr) throw std::bad_alloc();
  if (large) madvise(memory, whole, MADV_HUGEPAGE);
  return memory;
}

void prefer_large_pages(void* memory, std::size_t bytes) {
  const std::size_t before =
      rounded_up(reinterpret_cast<std::uintptr_t>(memory), kPage) - reinterpret_cast<std::uintptr_t>(memory);
  if (bytes < kLargePages || bytes < before + kPage) return;
  madvise(static_cast<char*>(memory) + before, (bytes - before) / kPage * kPage, MADV_HUGEPAGE);
}

std::shared_ptr<void> allocate(std::size_t bytes) {
  return {allocate_pages(bytes), [](void* p) { std::free(p); }};
}

std::shared_ptr<void> allocate_zeroed(std::size_t bytes) {
  const std::size_t whole = rounded_up(std::max<std::size_t>(bytes, 1), kPage) + kPage;
  void* const memory = mmap(nullptr, whole, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  auto* const aligned = static_cast<char*>(memory) + (rounded_up(address, kPage) - address);
  if (bytes >= kLargePages) madvise(aligned, rounded_up(bytes, kPage), MADV_HUGEPAGE);
  return {aligned, [memory, whole](void*) { munmap(memory, whole); }};
}

}  // namespace kdray
