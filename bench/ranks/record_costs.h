// What    What a tile's sums cost the threads that hand them over: as a record on the side of the rank that
//         rendered it, and back to sums on rank 0's (pdprt/borrower.cpp, lender.cpp).
// Units   Seconds of a core for a tile.
#pragma once

namespace kdray::bench {

struct RecordCosts {
  double deliver = 0, take_back = 0;
};

RecordCosts record_costs(int tile_width, int tile_height);

}  // namespace kdray::bench
