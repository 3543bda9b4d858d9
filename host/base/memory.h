// What    Memory for large arrays that a CPU device uses as it is: uninitialised, aligned for any vector, in
//         large pages where the system gives them; freed with its last owner. And the arrays that lie in it:
//         Array, whose size is fixed, RawVector and PageVector, which grow.
// Why     A walk through a tree touches memory all over; with pages of 4 KiB it waits for address translation
//         at each node (measured: a fifth of a packet walk was spent at its prefetches, which wait for it
//         too). And the first touch of a page costs many times a later one, so that nothing may be zeroed
//         that is about to be written.
// Errors  std::bad_alloc.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

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

// Allocates as above for a single owner, who gives it to std::free.
void* allocate_pages(std::size_t bytes);

// An array of plain values whose size is known when it is made, in memory that others may use as it is: a
// device's buffer or a file's mapping. It is a handle: copies share the values, which live as long as any of
// them or of their owner(). New values are uninitialised. What lies in a read-only mapping must not be
// written.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  Array() = default;
  explicit Array(std::size_t n) : size_(n) {
    if (n == 0) return;
    if (n > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_alloc();
    owner_ = allocate(n * sizeof(T));
    data_ = static_cast<T*>(owner_.get());
  }
  // `n` values at `data`, which `owner` keeps there.
  Array(std::shared_ptr<void> owner, T* data, std::size_t n)
      : owner_(std::move(owner)), data_(data), size_(n) {}

  static Array copy_of(std::span<const T> values) {
    Array copy(values.size());
    std::copy(values.begin(), values.end(), copy.begin());
    return copy;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  const std::shared_ptr<void>& owner() const { return owner_; }

 private:
  std::shared_ptr<void> owner_;
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// RawVector is a vector whose elements are left as they are when it grows: for arrays that are written once,
// by several threads, right after. emplace_back() leaves its element so too; push_back({}) adds an empty one.
// (std::vector fills what resize() adds, in one thread; memory that is touched for the first time costs
// several times what warm memory costs, and would be touched twice.) PageVector is for elements whose empty
// state means something: it has large pages too, but fills them as std::vector does.
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
