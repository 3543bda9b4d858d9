// What    The wide form of the kd-tree: three levels of the binary tree in one node of up to eight children,
//         and leaves of blocks of KDRAY_BLOCK primitives of one kind as structures of arrays.
// Shape   nodes[0] is the root. Child i of a node has the bounds lo, hi of its contents; a slot without child
//         has lo = +inf, hi = -inf, which no ray meets. order[octant] lists the slots from far to near in 3
//         bits each, lowest first, for rays whose direction has the octant's signs (bit k: negative along
//         axis k): pushed in that order, the nearest is popped first.
//         child: a node's index, or KDRAY_WIDE_LEAF | kind << KDRAY_WIDE_KIND_SHIFT | first block of the
//         kind's array. A leaf's blocks follow each other; the last of its primitives has KDRAY_WIDE_LAST in
//         its index, and so have the empty lanes behind it, whose coordinates are NaN.
// Source  Kd cells: Havran 2000. Collapsing binary trees: Dammertz, Hanika, Keller, EGSR 2008; Wald, Benthin,
//         Boulos, RT 2008.
#ifndef KDRAY_LAYOUT_WIDE_H
#define KDRAY_LAYOUT_WIDE_H
#include "layout/base.layout.h"
#include "layout/kinds.h"
#include "layout/primitives.layout.h"

#define KDRAY_WIDE_LEAF 0x80000000u
#define KDRAY_WIDE_KIND_SHIFT 27
#define KDRAY_WIDE_KIND_MASK 15u
#define KDRAY_WIDE_FIRST_MASK 0x07ffffffu
#define KDRAY_WIDE_NODE_MAX 0x1fffffffu
#define KDRAY_WIDE_LAST 0x80000000u

// The last row of every kind holds the primitives' indices.
#define KDRAY_CHECK_ROWS(NAME, name, names, Struct) \
  typedef char kdray_last_row_of_##name[KDRAY_ROW_##NAME##_INDEX == KDRAY_##NAME##_ROWS - 1 ? 1 : -1];
KDRAY_KINDS(KDRAY_CHECK_ROWS)

KDRAY_LAYOUT_BEGIN
typedef struct WideNode {
  float bounds[3][2][8];  // [axis][0: lo, 1: hi][slot]
  u32 child[8];
  u32 order[8];
} WideNode;
KDRAY_ASSERT_SIZE(WideNode, 256)
typedef char kdray_kinds_of_leaves[KDRAY_N_KINDS <= KDRAY_WIDE_KIND_MASK ? 1 : -1];
KDRAY_ASSERT_OFFSET(WideNode, child, 192)
KDRAY_LAYOUT_END
#endif
