// What    A vector whose elements are left as they are when it grows: for arrays that are written once, by
//         several threads, right after. emplace_back() leaves its element so too; push_back({}) adds an empty
//         one.
// Why     std::vector fills what resize() adds, in one thread; memory that is touched for the first time
//         costs several times what warm memory costs, and would be touched twice. Large ones come in large
//         pages (base/memory.h). PageVector is for elements whose empty state means something: large pages
//         too, but filled as std::vector does.
#pragma once

#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/memory.h"

namespace kdray {

template <class T>
struct PageAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = PageAllocator<U>;
  };
  T* allocate(std::size_t n) {
    if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
    return static_cast<T*>(allocate_pages(n * sizeof(T)));
  }
  void deallocate(T* p, std::size_t) noexcept { std::free(p); }
};

template <class T>
struct RawAllocator : PageAllocator<T> {
  static_assert(std::is_trivially_copyable_v<T>);
  template <class U>
  struct rebind {
    using other = RawAllocator<U>;
  };
  template <class U>
  void construct(U*) noexcept {}
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

template <class T>
using PageVector = std::vector<T, PageAllocator<T>>;

}  // namespace kdray
