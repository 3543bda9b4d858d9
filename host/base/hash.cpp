#include "base/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace kdray {

Hash hash_of(const void* bytes, std::size_t n) {
  const XXH128_hash_t hash = XXH3_128bits(bytes, n);
  return {hash.high64, hash.low64};
}

std::string in_hex(const Hash& hash) {
  return fmt::format("{:016x}{:016x}", hash.high, hash.low);
}

}  // namespace kdray
