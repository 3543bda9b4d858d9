// What    Values one after the other as a message's bytes, and texts with their lengths before them.
// Errors  ErrorCode::internal: bytes that end too early, or texts that are too long.
#pragma once

#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "cluster/transport/words.h"

namespace kdray::transport {

inline constexpr std::size_t kMostText = 1 << 16;

// Both are called with the values themselves, so that one function can name them for either.
class Writer {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    const std::string_view kept = std::string_view(text).substr(0, kMostText);
    put(kept.size());
    bytes_.append(kept);
  }

  Bytes bytes_;
};

class Reader {
 public:
  explicit Reader(const Message& message) : message_(message), rest_(message.bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  template <class T>
  T get() {
    T value;
    read(value);
    return value;
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  template <class T>
  void read(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (rest_.size() < sizeof value) refuse(message_);
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
  }
  void read(std::string& text) {
    const auto n = get<std::size_t>();
    if (n > kMostText || n > rest_.size()) refuse(message_);
    text = rest_.substr(0, n);
    rest_.remove_prefix(n);
  }

  const Message& message_;
  std::string_view rest_;
};

}  // namespace kdray::transport
