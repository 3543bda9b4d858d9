// What    The wide form's nodes compressed, for walks of one ray to a work-item: those of a GPU, whose time
//         goes with the bytes that it reads. They lie in the places of the nodes that they stand for, and
//         name the same children.
// Shape   The bounds of the children are in steps of 2^exponent from `origin`, along each axis, rounded
//         outward: origin + step * bounds[axis][0][slot] is lo or below it. `scales` has from its lowest byte
//         on the exponents' bytes of floats, and in the highest one a bit for each slot that has a child:
//         what stands in the others' bounds would be met.
// Source  Ylitie, Karras, Laine, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs",
//         HPG 2017.
#ifndef KDRAY_LAYOUT_COMPRESSED_H
#define KDRAY_LAYOUT_COMPRESSED_H
#include "layout/base.layout.h"

KDRAY_LAYOUT_BEGIN
typedef struct CompressedNode {
  float origin[3];
  u32 scales;
  u8 bounds[3][2][8];  // [axis][0: lo, 1: hi][slot]
  u32 child[8];
} CompressedNode;
KDRAY_ASSERT_SIZE(CompressedNode, 96)
KDRAY_ASSERT_OFFSET(CompressedNode, bounds, 16)
KDRAY_ASSERT_OFFSET(CompressedNode, child, 64)
KDRAY_LAYOUT_END
#endif
