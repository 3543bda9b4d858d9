// What    Memory for large data that is read sparsely, such as texels: plain memory up to a process-wide
//         budget, then pages of an unnamed file, which the system writes out and reads back as they are
//         needed.
// Shape   Plain memory has three quarters of the budget. When pages of files have more than the last quarter
//         in memory they are let go, all at once: those that are still looked at come back from the system's
//         file cache, which it frees as it likes. A thread watches this while there are such pages. Files lie
//         in $TMPDIR, or else in /var/tmp, and are gone when their memory is, or the process.
// Threads Any. Pages may be let go while others read and write them.
// Errors  kdray::Error, ErrorCode::input, when a budget was set and there is no space for a file. Otherwise
//         plain memory serves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "base/memory.h"

namespace kdray {

// Sets the budget, in bytes, for what is allocated from now on. Without this it is half of the memory that is
// free when it is first needed.
void set_paged_budget(std::uint64_t bytes);

// Returns memory, zeroed or not, that is aligned as allocate()'s is.
std::shared_ptr<void> allocate_paged(std::size_t bytes);

template <class T>
Array<T> paged_array(std::size_t n) {
  if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
  const std::shared_ptr<void> memory = allocate_paged(n * sizeof(T));
  return {memory, static_cast<T*>(memory.get()), n};
}

// Returns the memory of a mapped file as an owner that lets its pages go as if they had been allocated here,
// where it has more bytes than plain memory has left. `owner` keeps it there.
std::shared_ptr<void> page_mapped(std::shared_ptr<void> owner, void* memory, std::size_t bytes);

struct PagedBytes {
  std::uint64_t plain = 0, in_files = 0;
  std::uint64_t in_memory = 0;  // of those in files
};
PagedBytes paged_bytes();

}  // namespace kdray
