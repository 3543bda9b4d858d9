// What    An array of plain values whose size is known when it is made, in memory that others may use as it
//         is: a device's buffer or a file's mapping.
// Shape   A handle: copies share the values, which live as long as any of them or of their owner(). New
//         values are uninitialised. What lies in a read-only mapping must not be written.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

#include "base/memory.h"

namespace kdray {

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

}  // namespace kdray
