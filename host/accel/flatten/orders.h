// What    In which order rays of each octant visit a node's children when these are no longer cells of a
//         plane: the orders of a refitted form.
// Shape   Of two boxes that one goes first which lies before the other along the axis that parts them most,
//         or along which they overlap least. From the order that there was, children move forward past those
//         that they go before; so what still is right stays, and what no ray meets both of may be either way.
// Why     An order changes no hit, but a mesh that is turned round is walked from back to front by the orders
//         that it was built with, which takes rays twice as long.
#pragma once

#include <cstdint>

#include "layout/wide.layout.h"

namespace kdray::flatten {

// Rewrites the words of a node of n children whose bounds are set.
void order_anew(layout::WideNode& node, std::uint32_t n);

}  // namespace kdray::flatten
