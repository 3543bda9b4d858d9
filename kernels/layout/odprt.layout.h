// What    ODPRT: what a queue knows of the division of the scene, and what a slice counts.
// Shape   The scene is divided into parts; a ray carries how far it has come on its way through them, in two
//         words (odprt/way.clh).
#ifndef KDRAY_LAYOUT_ODPRT_H
#define KDRAY_LAYOUT_ODPRT_H
#include "layout/base.layout.h"
#include "layout/frame.layout.h"

#define KDRAY_MAX_PARTS 2048
#define KDRAY_NO_PART 4095u

KDRAY_LAYOUT_BEGIN
// Bounds of some of a part's contents; the cells that follow, if any are below it, are bounds of less of them
// each, and tell more.
typedef struct PartCell {
  float lo[3];
  u32 part;
  float hi[3];
  u32 n_below;
} PartCell;
KDRAY_ASSERT_SIZE(PartCell, 32)

// A queue that serves a part.
typedef struct Travel {
  u32 part;      // whose geometry is at hand
  u32 n_places;  // of a slice in the outbox: one for each part, or one for all
  u32 n_cells;   // of the directory
  u32 n_slices;
  u32 out_rays;          // rays that a place of the outbox holds
  u32 out_ray_capacity;  // words per field of those
  u32 out_shadow;        // the same of shadow rays
  u32 out_shadow_capacity;
  u32 shadow_pool;  // shadow rays from elsewhere that a slice can hold
  u32 shadow_pool_capacity;
  u32 n_shared;      // triangles that other parts hold too: the first ones, by number
  u32 n_subtrees;    // whose visitors are to be counted; 0: none are
  u32 census_every;  // ... in one wave of so many
  u32 replicated;    // 1: what most rays come to is held by every part
  u32 pad[2];
} Travel;
KDRAY_ASSERT_SIZE(Travel, 64)

// How many rays a slice may make in a launch beyond those that it ends: [0] shadow rays that leave the part
// where they begin, [d] rays of depth d.
typedef struct Credits {
  u32 rays[KDRAY_MAX_DEPTH + 1];
} Credits;
KDRAY_ASSERT_SIZE(Credits, 260)

// A slice's account of a launch, in the same order.
typedef struct Traffic {
  u32 made[KDRAY_MAX_DEPTH + 1];
  u32 ended[KDRAY_MAX_DEPTH + 1];  // wherever they were made
  u32 n_shadow_pool;               // shadow rays from elsewhere that wait; stays from launch to launch
  u32 n_waves;
  u32 n_lost;  // rays that the part which found their hit didn't find again: a broken rule
  u32 pad;
  u64 n_traced;  // rays of both kinds
  u64 cycles_route;
  // Where every ray has a work-item: of the wave in work (odprt/stages/plan.cl).
  u64 n_ended;           // rays that are shaded here
  u64 n_left;            // shadow rays that go on elsewhere
  u64 n_primary_before;  // eye rays that were made, and rays of the next depth in the pool
  u32 n_pool_before;
  u32 is_counted;  // 1: visits to subtrees are counted
} Traffic;
KDRAY_ASSERT_SIZE(Traffic, 584)
KDRAY_LAYOUT_END
#endif
