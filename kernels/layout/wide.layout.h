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

#define KDRAY_WIDE_LEAF 0x80000000u
#define KDRAY_WIDE_KIND_SHIFT 27
#define KDRAY_WIDE_KIND_MASK 15u
#define KDRAY_WIDE_FIRST_MASK 0x07ffffffu
#define KDRAY_WIDE_NODE_MAX 0x1fffffffu
#define KDRAY_WIDE_LAST 0x80000000u

// The rows of KDRAY_BLOCK words in a block. The last row of every kind holds the primitives' indices.
#define KDRAY_ROW_TRIANGLE_PX 0  // the corners p, q and r
#define KDRAY_ROW_TRIANGLE_PY 1
#define KDRAY_ROW_TRIANGLE_PZ 2
#define KDRAY_ROW_TRIANGLE_QX 3
#define KDRAY_ROW_TRIANGLE_QY 4
#define KDRAY_ROW_TRIANGLE_QZ 5
#define KDRAY_ROW_TRIANGLE_RX 6
#define KDRAY_ROW_TRIANGLE_RY 7
#define KDRAY_ROW_TRIANGLE_RZ 8
#define KDRAY_ROW_TRIANGLE_LIMIT \
  9  // |n|_1 + 8|edge|^2 for sign_limit (triangle.clh); < 0: lies across an axis; infinity: it has no area
#define KDRAY_ROW_TRIANGLE_INDEX 10
#define KDRAY_TRIANGLE_ROWS 11

#define KDRAY_ROW_SPHERE_X 0  // the centre
#define KDRAY_ROW_SPHERE_Y 1
#define KDRAY_ROW_SPHERE_Z 2
#define KDRAY_ROW_SPHERE_RADIUS 3
#define KDRAY_ROW_SPHERE_INDEX 4
#define KDRAY_SPHERE_ROWS 5

#define KDRAY_ROW_CONE_X 0  // the base's centre
#define KDRAY_ROW_CONE_Y 1
#define KDRAY_ROW_CONE_Z 2
#define KDRAY_ROW_CONE_AXIS_X 3
#define KDRAY_ROW_CONE_AXIS_Y 4
#define KDRAY_ROW_CONE_AXIS_Z 5
#define KDRAY_ROW_CONE_RADIUS 6  // of the base
#define KDRAY_ROW_CONE_HEIGHT 7
#define KDRAY_ROW_CONE_SLOPE 8
#define KDRAY_ROW_CONE_INDEX 9
#define KDRAY_CONE_ROWS 10

#define KDRAY_ROW_DISC_X 0  // the centre
#define KDRAY_ROW_DISC_Y 1
#define KDRAY_ROW_DISC_Z 2
#define KDRAY_ROW_DISC_NORMAL_X 3
#define KDRAY_ROW_DISC_NORMAL_Y 4
#define KDRAY_ROW_DISC_NORMAL_Z 5
#define KDRAY_ROW_DISC_RADIUS 6
#define KDRAY_ROW_DISC_INDEX 7
#define KDRAY_DISC_ROWS 8

#define KDRAY_ROW_TORUS_X 0  // the centre
#define KDRAY_ROW_TORUS_Y 1
#define KDRAY_ROW_TORUS_Z 2
#define KDRAY_ROW_TORUS_AXIS_X 3
#define KDRAY_ROW_TORUS_AXIS_Y 4
#define KDRAY_ROW_TORUS_AXIS_Z 5
#define KDRAY_ROW_TORUS_MAJOR 6
#define KDRAY_ROW_TORUS_MINOR 7
#define KDRAY_ROW_TORUS_INDEX 8
#define KDRAY_TORUS_ROWS 9

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
