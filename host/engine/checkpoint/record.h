// What    A finished tile or run of samples of a frame as bytes: the film's sums, with what they are of and
//         checksums. Records lie one after the other in a file (record_file.h), or are sent.
// Shape   A head, then three 64-bit sums for each place, row by row. Of a tile the places are its pixels; of
//         a run its samples, in one row.
// Units   Sums are the film's (kernels/layout/frame.layout.h); lengths in bytes, multiples of 8.
// Why     Sums are whole numbers: whoever renders a tile or a run, however it was divided, gets the same
//         ones. Two records of one that differ tell of a machine that computes wrongly.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/hash.h"
#include "layout/frame.layout.h"

namespace kdray::checkpoint {

using Sums = std::span<const layout::i64>;

// Places of a frame's sums, of which `x` and `y` are the first.
struct Rectangle {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  std::size_t sums() const { return std::size_t{3} * width * height; }
  bool operator==(const Rectangle&) const = default;
};

// Round 0 has the picture's tiles; further rounds, of adaptive sampling, have runs of samples. `number` is
// the entry of a queue's list: KDRAY_TILE, or the run's number.
struct RecordId {
  std::uint32_t round = 0, number = 0;
  Rectangle places;
  bool operator==(const RecordId&) const = default;
};

struct RecordHead {
  char magic[8];
  std::uint64_t bytes;  // of the whole record
  Hash frame;           // Header::frame(): a record of another frame is none here
  RecordId id;
  Hash content;  // of the sums
  Hash check;    // of the head before it
};
inline constexpr std::size_t kRecordHead = sizeof(RecordHead);
static_assert(kRecordHead == 88);

inline Hash hash_of_sums(Sums sums) {
  return hash_of(sums.data(), sums.size_bytes());
}

// `content` is hash_of_sums(sums).
void append_record(std::string& to, const Hash& frame, const RecordId& id, Sums sums, const Hash& content);

// The head that the bytes begin with, when it is whole and of this frame.
std::optional<RecordHead> head_of(std::string_view bytes, const Hash& frame);

// Where a head may begin in the bytes, from `from` on and at a multiple of 8; npos: nowhere.
std::size_t find_record(std::string_view bytes, std::size_t from);

}  // namespace kdray::checkpoint
