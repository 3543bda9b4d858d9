// What    What a frame's kernels know: camera, picture, limits; and the state of a slice.
#ifndef KDRAY_LAYOUT_FRAME_H
#define KDRAY_LAYOUT_FRAME_H
#include "layout/base.layout.h"

// The film holds sums in units of 2^-36: 64-bit integers, so that adding is exact and has no order. One
// contribution is cut at 2^20; sums saturate at 2^27.
#define KDRAY_FILM_SCALE 68719476736.0f
#define KDRAY_FILM_MAX 1048576.0f

#define KDRAY_MAX_DEPTH 64
// The weight from which on a refracted ray that is too deep counts as one that matters: a tenth of its pixel.
#define KDRAY_GLASS_MATTERS 0.1f
#define KDRAY_MAX_LIGHT_BATCH 8

KDRAY_LAYOUT_BEGIN
typedef struct Frame {
  // A sample at (sx, sy), in pixels from the whole picture's top left, looks from eye along
  // forward + x*right + y*up with x = sx*x_scale + x_offset and y = sy*y_scale + y_offset; of a parallel
  // camera, from eye + x*right + y*up along forward.
  float eye[3];
  float hither;
  float forward[3];
  float x_scale;
  float right[3];
  float x_offset;
  float up[3];
  float y_scale;
  float background[3];
  float y_offset;
  float root_lo[3];  // the root's cell
  float world_max;   // largest |coordinate| of the root's cell
  float root_hi[3];
  float spawn_threshold;  // a ray whose largest weight is below this is not spawned
  u32 width, height;
  u32 tile_width, tile_height;
  u32 n_tiles_x, n_tiles;
  u32 n_samples;
  u32 max_depth;
  u32 n_lights;
  u32 corner_grid;      // 1: samples at the pixels' corners, 0: at their centres
  u32 batch_size;       // rays a slice traces in one wave
  u32 batch_capacity;   // words per field of a batch, of its hits and of one light's shadow rays
  u32 pool_size;        // rays of one depth that a slice's pool can hold
  u32 pool_capacity;    // words per field of one depth of the pool
  u32 light_batch;      // lights served between two waves of shadow rays
  u32 shadow_capacity;  // words per field of a slice's shadow rays
  u32 first_pixel;      // the film buffer begins with this pixel
  // 1: rays of no weight are traced too (--min-weight 0), as the SPD's ray counts have them.
  u32 keep_weightless;
  u32 open_lights;  // bit i: light i is on the inner side of all faces
  u32 samples_at;   // adaptive rounds: where the samples begin in the list's buffer, in words; 0: whole tiles
  // The box of all but the triangles that lie in faces: planes that bound the scene along an axis, infinite
  // where there are none (host/accel/flatten/core.h).
  float core_lo[3], core_hi[3];
  float face_lo[3], face_hi[3];
  u32 parallel;  // 1: an orthographic camera
  // The side of the square that a sample stands for: at the distance 1 along `forward`, or of a parallel
  // camera anywhere. In adaptive rounds a pixel's, of which samples have shares (raygen/sequence.clh).
  float ray_cone;
  // A lens: eye rays start so far from `eye` at most, and are turned back by so much for what is in focus to
  // stay where it is; 0: a pinhole.
  float lens_radius, lens_slope;
  u32 tells_sample;  // 1: rays have a word that tells their sample (KDRAY_RAY_SAMPLE)
  u32 has_sky;       // 1: the background is the sky's; 0: it is of one colour, above
  // A floor (shade/floor.clh): a disc about a point that fades from `floor_inner` to `floor_radius`.
  float floor_middle[3];
  float floor_radius;  // 0: there is none
  float floor_up[3];   // unit
  float floor_inner;
  float floor_unshadowed[3];
  float floor_reflect;
  float floor_diffuse[3];
  // The frame may be a part of a picture, so many pixels across, that begins at (crop_x, crop_y) of it.
  u32 crop_x, crop_y, whole_width;
} Frame;
KDRAY_ASSERT_SIZE(Frame, 336)
KDRAY_ASSERT_OFFSET(Frame, core_lo, 192)
KDRAY_ASSERT_OFFSET(Frame, width, 112)

// An entry of a queue's list of tiles: the tile's column and row in the picture.
#define KDRAY_TILE_COLUMN(entry) ((entry)&0xffffu)
#define KDRAY_TILE_ROW(entry) ((entry) >> 16)
#define KDRAY_TILE(column, row) ((column) | (row) << 16)

// A round of adaptive sampling: the entries are the numbers of runs, each of so many samples, of which the
// buffer holds first the pixels (column and row, as a tile's entry has them), then which of their pixel's
// sequence they are. Sample i adds to place i of the film, which has room for the samples instead of the
// pixels: each sample's light is known by itself.
#define KDRAY_SAMPLE_RUN 256u
#define KDRAY_NO_SAMPLE 0xffffffffu  // for a pixel: what fills the last run up

// Slice s works through the entries s, s + tile_stride, ... of its queue's list, which grows. One work-item
// at a time owns it, so its counters need no atomics; the host adds them up.
typedef struct Slice {
  u64 next_place;   // the next pixel of the tile, in the order of raygen/place.clh
  u32 next_sample;  // ... and its next sample
  u32 tile;         // the entry in work; not in the list yet: none left
  u32 tile_stride;
  u32 depth;  // of the batch in work; the eye rays have 1
  u32 n_batch;
  u32 n_shadow;
  u32 n_waves;  // with rays in them
  u32 eye;      // 1: the batch is of eye rays, of those before next_place; where every ray has a work-item
  u32 n_pool[KDRAY_MAX_DEPTH];  // rays of depth d that wait: n_pool[d - 1]
  u64 n_primary, n_primary_hit, n_shadow_rays, n_reflected, n_refracted;
  u64 n_skipped_behind;      // shadow rays to lights behind the surface
  u64 n_skipped_unlit;       // ... to lights out of reach or outside their cone, or of no weight
  u64 n_skipped_open;        // ... that nothing can be in the way of
  u64 n_skipped_background;  // secondary rays that surely meet nothing
  u64 n_skipped_weight;      // secondary rays below the spawn threshold
  u64 n_skipped_depth;       // secondary rays deeper than the limit
  u64 n_skipped_glass;       // ... of them those through transmitting surfaces that matter to their pixel
  u64 n_invalid;             // rays whose traversal failed
  u64 n_nan;                 // contributions that were not numbers
  u64 n_pool_overflow;       // spawned rays that found no place: a broken bound
  u64 n_of_empty_blocks;     // of n_primary: not made, since their block of pixels sees nothing
  u64 cycles_admit, cycles_closest, cycles_shade, cycles_shadow, cycles_add;  // wave.cl
  // For closest hits and for any, by depth: how often the distance that a packet's rays may start apart was
  // halved (traverse/learn.clh).
  u8 halvings[2][KDRAY_MAX_DEPTH + 1];
  u8 pad2[46];  // no two slices share a line of a cache
} Slice;
KDRAY_ASSERT_SIZE(Slice, 640)
KDRAY_ASSERT_OFFSET(Slice, n_primary, 296)
KDRAY_LAYOUT_END
#endif
