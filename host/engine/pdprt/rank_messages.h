// What    What ranks say to each other while they render a frame's lists of tiles, as bytes and back.
// Shape   A server of tiles (tile_hierarchy.h) begins a list, is asked for tiles (want), grants some, and
//         gets their sums as records of a checkpoint; when all lists are done rank 0 finishes the frame,
//         which is passed on, and gets a report from each. Every message names its list, by a number that
//         goes up over all frames of a run.
// Errors  ErrorCode::internal: bytes that are no such message. Values are checked by whoever knows the list.
#pragma once

#include "cluster/transport/message_bytes.h"
#include "cluster/transport/ranks.h"
#include "engine/checkpoint/header.h"
#include "layout/frame.layout.h"

namespace kdray::pdprt {

inline constexpr transport::Tag kBegin = transport::kTagsOfTiles.first, kWant = kBegin + 1,
                                kGrant = kBegin + 2, kRecords = kBegin + 3, kFinish = kBegin + 4,
                                kReport = kBegin + 5;

struct Begin {
  std::uint32_t list = 0, of_runs = 0;
  std::uint64_t first_pixel = 0, n_entries = 0;  // the film's first, of tiles; of the list
};

struct Want {
  std::uint32_t list = 0, least = 0, n_rendered = 0, unused = 0;
};

struct Grant {
  std::uint32_t list = 0;
  std::uint32_t is_over = 0;  // nothing more comes
  std::uint64_t n_left = 0;   // that nobody has, for each rank
};

struct Records {
  std::uint32_t list = 0, unused = 0;
};

struct Finish {
  std::uint32_t list = 0;  // the last
};

// What all ranks have to agree on about a frame.
struct SharedFrame {
  Hash frame;  // checkpoint::Header::frame()
  std::uint32_t width = 0, height = 0, tile_width = 0, tile_height = 0;

  // Nowhere (no width): there is no such entry.
  checkpoint::Rectangle places_of(bool of_runs, layout::u32 entry) const {
    return checkpoint::places_of({width, height, tile_width, tile_height}, of_runs ? 1 : 0, entry);
  }
};

using transport::head_of, transport::refuse, transport::to_bytes, transport::words_behind;

}  // namespace kdray::pdprt
