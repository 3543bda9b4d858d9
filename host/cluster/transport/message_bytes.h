// What    What messages are made of: a head, which is a plain structure, with words behind it; or values one
//         after the other, and texts with their lengths before them.
// Errors  ErrorCode::internal: bytes that are no such message, that end too early, or a text that is too
//         long. What the values mean is checked by whoever reads them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cluster/transport/transport.h"

namespace kdray::transport {

template <class Head>
Bytes to_bytes(const Head& head, std::span<const std::uint32_t> words = {}) {
  static_assert(std::is_trivially_copyable_v<Head> && sizeof(Head) % sizeof(std::uint32_t) == 0);
  Bytes bytes(reinterpret_cast<const char*>(&head), sizeof head);
  return bytes.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
}

[[noreturn]] void refuse(const Message& message);

template <class Head>
Head head_of(const Message& message) {
  Head head;
  if (message.bytes.size() < sizeof head) refuse(message);
  std::copy_n(message.bytes.data(), sizeof head, reinterpret_cast<char*>(&head));
  return head;
}

template <class Head>
std::vector<std::uint32_t> words_behind(const Message& message) {
  if (message.bytes.size() < sizeof(Head)) refuse(message);
  const std::size_t n = message.bytes.size() - sizeof(Head);
  if (n % sizeof(std::uint32_t) != 0) refuse(message);
  std::vector<std::uint32_t> words(n / sizeof(std::uint32_t));
  std::copy_n(message.bytes.data() + sizeof(Head), n, reinterpret_cast<char*>(words.data()));
  return words;
}

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
