// What    A record of a checkpoint whose head is anything but for its checksums, which no fuzzer guesses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/checkpoint/record.h"

namespace kdray::fuzz {

inline std::string with_checksums(std::string_view bytes, const Hash& frame) {
  checkpoint::RecordHead head{};
  std::string record(std::max(bytes.size(), sizeof head), '\0');
  bytes.copy(record.data(), bytes.size());
  std::memcpy(&head, record.data(), sizeof head);
  std::memcpy(head.magic, "kdraytil", sizeof head.magic);
  head.frame = frame;
  head.content = hash_of(record.data() + sizeof head, record.size() - sizeof head);
  head.check = hash_of(&head, offsetof(checkpoint::RecordHead, check));
  std::memcpy(record.data(), &head, sizeof head);
  return record;
}

}  // namespace kdray::fuzz
