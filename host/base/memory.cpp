#include "base/memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <new>
#include <vector>

namespace kdray {

namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;
constexpr std::size_t kAlignment = 128;  // the widest vector of OpenCL: long16

std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

// Smaller blocks stay with malloc when they are freed anyway (cli/main.cpp; glibc's own limit).
constexpr std::size_t kLeastKept = std::size_t{32} << 20, kMostKept = std::size_t{256} << 20;
constexpr std::size_t kBlocksKept = 2;

// Keeps the blocks that were freed last, to hand them out again.
class Kept {
 public:
  // The instance is never destroyed, since what owns memory may outlive it.
  static Kept& all() {
    static Kept* const kept = new Kept;
    return *kept;
  }

  void* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(blocks_.begin(), blocks_.end(), [&](const Block& b) { return b.bytes == bytes; });
    if (found == blocks_.end()) return nullptr;
    void* const memory = found->memory;
    blocks_.erase(found);
    return memory;
  }

  void keep(void* memory, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (blocks_.size() == kBlocksKept) {
      std::free(blocks_.front().memory);
      blocks_.erase(blocks_.begin());
    }
    blocks_.push_back({memory, bytes});
  }

 private:
  struct Block {
    void* memory;
    std::size_t bytes;
  };

  Kept() { blocks_.reserve(kBlocksKept); }

  std::mutex mutex_;
  std::vector<Block> blocks_;
};

}  // namespace

// Large pages are taken whole; the system may refuse the hint, and small pages do as well.
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

void make_pages(void* memory, std::size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  constexpr std::size_t kSmallPage = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(memory);
  const std::size_t before = rounded_up(address, kSmallPage) - address;
  if (bytes < before + kSmallPage) return;
  // A system that doesn't know this request makes the pages when they are touched.
  madvise(static_cast<char*>(memory) + before, (bytes - before) / kSmallPage * kSmallPage,
          MADV_POPULATE_WRITE);
#else
  (void)memory, (void)bytes;
#endif
}

std::shared_ptr<void> allocate(std::size_t bytes) {
  const bool kept = bytes >= kLeastKept && bytes <= kMostKept;
  void* const memory = kept ? Kept::all().take(bytes) : nullptr;
  return {memory ? memory : allocate_pages(bytes),
          [bytes, kept](void* p) { kept ? Kept::all().keep(p, bytes) : std::free(p); }};
}

}  // namespace kdray
