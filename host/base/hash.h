// What    128-bit hashes of bytes, to tell contents apart and to find damage; not safe against forgery.
// Source  XXH3 (Collet), at memory speed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace kdray {

struct Hash {
  std::uint64_t high = 0, low = 0;
  bool operator==(const Hash&) const = default;
};

Hash hash_of(const void* bytes, std::size_t n);
inline Hash hash_of(std::string_view bytes) {
  return hash_of(bytes.data(), bytes.size());
}

std::string in_hex(const Hash& hash);  // 32 digits

}  // namespace kdray
