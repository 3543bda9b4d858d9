#include "pdprt/rank_messages.h"

#include <fmt/format.h>

namespace kdray::pdprt {

ledger::Rectangle SharedFrame::places_of(bool of_runs, layout::u32 entry) const {
  return ledger::places_of({width, height, tile_width, tile_height}, of_runs ? 1 : 0, entry);
}

void refuse(const transport::Message& message) {
  throw Error(ErrorCode::internal, fmt::format("rank {} sent {} bytes with tag {}, which mean nothing here",
                                               message.from, message.bytes.size(), message.tag));
}

}  // namespace kdray::pdprt
