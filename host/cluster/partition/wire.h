// What    Lists of plain values in the bytes of a message, one behind the other, and back.
// Shape   As they lie in memory: all ranks run the same build.
// Errors  ErrorCode::internal where a message is shorter or longer than what is taken from it.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "cluster/transport/together.h"

namespace kdray::partition {

class WireWriter {
 public:
  explicit WireWriter(transport::Bytes& bytes) : bytes_(bytes) {}

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class List>
  void put_all(const List& values) {
    using T = std::remove_cvref_t<decltype(values[0])>;
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  // Those at these places.
  template <class List, class Places>
  void put_some(const List& values, const Places& places) {
    bytes_.reserve(bytes_.size() + places.size() * sizeof(values[0]));
    for (const auto place : places) put(values[place]);
  }

 private:
  transport::Bytes& bytes_;
};

class WireReader {
 public:
  WireReader(const transport::Bytes& bytes, int from) : bytes_(bytes), from_(from) {}

  template <class T>
  T get() {
    T value;
    std::memcpy(static_cast<void*>(&value), next(sizeof(T)), sizeof(T));
    return value;
  }
  // There has to be memory for n of them.
  template <class T>
  void get_all(T* to, std::size_t n) {
    if (n > left() / sizeof(T)) transport::throw_odd_message(from_);
    const char* const first = next(n * sizeof(T));
    if (n > 0) std::memcpy(static_cast<void*>(to), first, n * sizeof(T));
  }
  // Behind what a list has.
  template <class List>
  void take(List& list, std::size_t n) {
    using T = typename List::value_type;
    if (n > left() / sizeof(T)) transport::throw_odd_message(from_);
    const std::size_t before = list.size();
    list.resize(before + n);
    get_all(list.data() + before, n);
  }
  void end() const {
    if (left() != 0) transport::throw_odd_message(from_);
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  const char* next(std::size_t n) {
    if (n > left()) transport::throw_odd_message(from_);
    at_ += n;
    return bytes_.data() + at_ - n;
  }

  const transport::Bytes& bytes_;
  int from_;
  std::size_t at_ = 0;
};

}  // namespace kdray::partition
