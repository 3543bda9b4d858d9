// What    The binary form of the kd-tree: 8 bytes a node, and the references its leaves hold.
// Shape   nodes[0] is the root; an inner node's child below the plane follows it directly.
//           inner: word0 = bits of the split coordinate
//                  word1 = index of the child above the plane * 4 + axis (0, 1, 2)
//           leaf:  word0 = first reference
//                  word1 = number of references * 4 + 3
//         A reference is the number of the primitive's kind (kinds.h) in its top four bits and its index
//         below them.
// Source  pbrt's and Havran's compact nodes; here the count and the child share one word.
#ifndef KDRAY_LAYOUT_TREE_H
#define KDRAY_LAYOUT_TREE_H
#include "layout/base.layout.h"
#include "layout/kinds.h"

#define KDRAY_NODE_LEAF 3u
#define KDRAY_NODE_MAX 0x3fffffffu  // largest child index, and largest leaf
#define KDRAY_REF_KIND_SHIFT 28
#define KDRAY_REF_INDEX_MASK 0x0fffffffu
// The kind of what is no reference; no primitive has it.
#define KDRAY_REF_NO_KIND 15u
#define KDRAY_REF_MISS 0xffffffffu  // a ray that hits nothing
// A ray whose traversal failed (stack): counted, never taken for a miss.
#define KDRAY_REF_INVALID 0xfffffffeu

KDRAY_LAYOUT_BEGIN
typedef struct KdNode {
  u32 word0;
  u32 word1;
} KdNode;
KDRAY_ASSERT_SIZE(KdNode, 8)
typedef char kdray_kinds_below_the_sentinels[KDRAY_N_KINDS <= KDRAY_REF_NO_KIND ? 1 : -1];
KDRAY_LAYOUT_END
#endif
