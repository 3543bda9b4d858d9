#include "engine/checkpoint/record.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace kdray::checkpoint {

namespace {

constexpr char kRecordMagic[8] = {'k', 'd', 'r', 'a', 'y', 't', 'i', 'l'};
static_assert(std::is_trivially_copyable_v<RecordHead>);

Hash check_of(const RecordHead& head) {
  return hash_of(&head, offsetof(RecordHead, check));
}

std::uint64_t bytes_of(const Rectangle& places) {
  return kRecordHead + places.sums() * sizeof(layout::i64);
}

}  // namespace

void append_record(std::string& to, const Hash& frame, const RecordId& id, Sums sums, const Hash& content) {
  RecordHead head{};
  std::copy(std::begin(kRecordMagic), std::end(kRecordMagic), head.magic);
  head.bytes = bytes_of(id.places);
  head.frame = frame;
  head.id = id;
  head.content = content;
  head.check = check_of(head);
  to.append(reinterpret_cast<const char*>(&head), sizeof head);
  to.append(reinterpret_cast<const char*>(sums.data()), sums.size_bytes());
}

std::optional<RecordHead> head_of(std::string_view bytes, const Hash& frame) {
  if (bytes.size() < kRecordHead) return std::nullopt;
  RecordHead head;
  std::memcpy(&head, bytes.data(), sizeof head);
  if (!std::equal(std::begin(kRecordMagic), std::end(kRecordMagic), head.magic) ||
      head.check != check_of(head) || head.frame != frame || head.bytes != bytes_of(head.id.places))
    return std::nullopt;
  return head;
}

std::size_t find_record(std::string_view bytes, std::size_t from) {
  for (std::size_t at = from; at + sizeof kRecordMagic <= bytes.size(); at += 8)
    if (std::memcmp(bytes.data() + at, kRecordMagic, sizeof kRecordMagic) == 0) return at;
  return std::string_view::npos;
}

}  // namespace kdray::checkpoint
