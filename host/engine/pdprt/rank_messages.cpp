#include "engine/pdprt/rank_messages.h"

namespace kdray::pdprt {

checkpoint::Rectangle SharedFrame::places_of(bool of_runs, layout::u32 entry) const {
  return checkpoint::places_of({width, height, tile_width, tile_height}, of_runs ? 1 : 0, entry);
}

}  // namespace kdray::pdprt
