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

// Of 32 to 256 MiB, what was freed last is kept for the next that asks for as much, two blocks at most: the
// ray pools of deep frames, which would be mapped and touched anew for each.
std::shared_ptr<void> allocate(std::size_t bytes);

// Asks for large pages where memory of another allocator is large, before it is touched.
void prefer_large_pages(void* memory, std::size_t bytes);

// Has the pages made that lie wholly within, which are about to be written for the first time: by another
// thread, while this one has something else to do. What they hold stays or becomes 0.
void make_pages(void* memory, std::size_t bytes);

// The same for one owner, to be given to std::free.
void* allocate_pages(std::size_t bytes);

}  // namespace kdray
