// What    Messages as a head, a plain structure, and what lies behind it.
// Errors  ErrorCode::internal: bytes that are no such message. Values are checked by whoever knows them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
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
  const std::size_t n = message.bytes.size() - sizeof(Head);
  if (n % sizeof(std::uint32_t) != 0) refuse(message);
  std::vector<std::uint32_t> words(n / sizeof(std::uint32_t));
  std::copy_n(message.bytes.data() + sizeof(Head), n, reinterpret_cast<char*>(words.data()));
  return words;
}

}  // namespace kdray::transport
