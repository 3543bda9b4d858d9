// What    The rules by which kernels leave work out, each with a bit of the feature mask that switches it
//         off: for `kdray bench ablation`, and for tests. A program built without such bits, as all others
//         are, holds no switch.
// Shape   KDRAY_SKIPS(BEHIND) is 1 where the rule holds, a constant. The rules that are numbers of Frame
//         (least weight, depth) have no bit.
// Why     They change time alone: no bit of a picture depends on them, except for LEFT with shadow rays of
//         smooth triangles, which may start behind the triangle. docs/design/skipping.md says why, and what
//         each is worth.
#ifndef KDRAY_LAYOUT_RULES_H
#define KDRAY_LAYOUT_RULES_H

// Tracing.
#define KDRAY_KEEP_FRUSTUM 0x0001ul   // packets: the children of a node that the frustum misses
#define KDRAY_KEEP_OCCLUDER 0x0002ul  // packets: the walk of rays that the leaf before stops as well
#define KDRAY_KEEP_NEARNESS 0x0004ul  // the roots of cones that a line surely passes by
#define KDRAY_KEEP_BEYOND 0x0008ul    // children that a ray enters behind its best hit
// Shading.
#define KDRAY_KEEP_BEHIND 0x0010ul  // shadow rays towards lights behind the surface
// Shadow rays whose light rounds to nothing on the film, or doesn't reach.
#define KDRAY_KEEP_UNLIT 0x0020ul
#define KDRAY_KEEP_WEIGHTLESS 0x0040ul  // secondary rays of no weight
#define KDRAY_KEEP_LEFT 0x0080ul        // rays against the triangle that they leave
#define KDRAY_KEEP_OPEN 0x0100ul        // rays that surely meet nothing (shade/open.clh)
// Eye rays.
#define KDRAY_KEEP_EMPTY 0x0200ul  // those of blocks of pixels that see nothing (raygen/empty_blocks.clh)

#define KDRAY_KEEP_TRACING \
  (KDRAY_KEEP_FRUSTUM | KDRAY_KEEP_OCCLUDER | KDRAY_KEEP_NEARNESS | KDRAY_KEEP_BEYOND)
#define KDRAY_KEEP_SHADING \
  (KDRAY_KEEP_BEHIND | KDRAY_KEEP_UNLIT | KDRAY_KEEP_WEIGHTLESS | KDRAY_KEEP_LEFT | KDRAY_KEEP_OPEN)
#define KDRAY_KEEP_ALL (KDRAY_KEEP_TRACING | KDRAY_KEEP_SHADING | KDRAY_KEEP_EMPTY)

#define KDRAY_SKIPS(rule) ((KDRAY_FEATURES & KDRAY_KEEP_##rule) == 0)
#endif
