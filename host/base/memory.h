// What    Memory for large arrays that a CPU device uses as it is: uninitialised, aligned for any vector, in
//         large pages where the system gives them; freed with its last owner.
// Why     A walk through a tree touches memory all over; with pages of 4 KiB it waits for address translation
//         at each node (measured: a fifth of a packet walk was spent at its prefetches, which wait for it
//         too). And the first touch of a page costs many times a later one, so that nothing may be zeroed
//         that is about to be written.
// Errors  std::bad_alloc.
#pragma once

#include <cstddef>
#include <memory>

namespace kdray {

// From this size on memory comes in large pages.
inline constexpr std::size_t kLargePages = std::size_t{4} << 20;

// Blocks of 32 to 256 MiB are kept when they are freed, two at most, and serve the next request of the same
// size: the ray pools of deep frames would otherwise be mapped and touched anew for each.
std::shared_ptr<void> allocate(std::size_t bytes);

// Asks for large pages where memory of another allocator is large, before it is touched.
void prefer_large_pages(void* memory, std::size_t bytes);

// Has the system make the pages that lie wholly within, and are about to be written for the first time, while
// this thread has something else to do. What they hold stays, or becomes 0.
void make_pages(void* memory, std::size_t bytes);

// The same for a single owner, who gives it to std::free.
void* allocate_pages(std::size_t bytes);

}  // namespace kdray
