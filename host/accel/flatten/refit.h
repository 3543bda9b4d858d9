// What    The wide form of a scene whose triangles have moved: the nodes and leaves of the form as it was
//         built, with bounds and corners of where the triangles are now; and what a ray is expected to cost.
// Shape   What doesn't change is shared with the old form, as blocks of other kinds, or copied, as the words
//         of children. Bounds are those of the pieces (pieces.h), joined from the leaves to the root; orders
//         follow them (orders.h), and the stack's size follows the orders.
// Why     A walk asks no more of the form than that some leaf whose bounds hold a place of a primitive names
//         it (docs/design/refit.md): orders may be wrong, and bounds may overlap.
#pragma once

#include "accel/flatten/pieces.h"
#include "accel/flatten/wide.h"

namespace kdray::flatten {

// The expected steps of a ray that meets the root: a node is one, and a block of a leaf. By the surface-area
// heuristic; 0 where the root has no surface.
double expected_cost(const WideForm& form);

struct Refit {
  WideForm form;
  double cost = 0;  // expected_cost() of it
};

// `triangles` are those that the form was built of, in the same order, wherever they are now.
Refit refit(const WideForm& form, const Pieces& pieces, const Array<layout::Triangle>& triangles);

}  // namespace kdray::flatten
