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

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put_text(const std::string& text) {
    const std::string_view kept = std::string_view(text).substr(0, kMostText);
    put(kept.size());
    bytes_.append(kept);
  }
  // All of them, as Reader reads them.
  template <class... T>
  void operator()(const T&... values) {
    (put_any(values), ...);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  template <class T>
  void put_any(const T& value) {
    if constexpr (std::is_same_v<T, std::string>)
      put_text(value);
    else
      put(value);
  }

  Bytes bytes_;
};

class Reader {
 public:
  explicit Reader(const Message& message) : message_(message), rest_(message.bytes) {}

  template <class T>
  T get() {
    T value;
    if (rest_.size() < sizeof value) refuse(message_);
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  bool is_at_end() const { return rest_.empty(); }

  std::string get_text() {
    const auto n = get<std::size_t>();
    if (n > kMostText || n > rest_.size()) refuse(message_);
    std::string text(rest_.substr(0, n));
    rest_.remove_prefix(n);
    return text;
  }

  template <class... T>
  void operator()(T&... values) {
    ((values = get_any<T>()), ...);
  }

 private:
  template <class T>
  T get_any() {
    if constexpr (std::is_same_v<T, std::string>)
      return get_text();
    else
      return get<T>();
  }

  const Message& message_;
  std::string_view rest_;
};

}  // namespace kdray::transport
