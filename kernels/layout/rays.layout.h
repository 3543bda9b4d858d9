// What    Rays, hits and shadow rays as they lie in a slice's streams, and the rays and hits of `kdray
//         trace`.
// Shape   A stream is a structure of arrays of words in one buffer: floats, or doubles in a program of that
//         precision (common/real.clh). Field f of ray i of slice s lies at [(s*FIELDS + f)*capacity + i]. The
//         capacity (frame.layout.h) leaves KDRAY_LANES words behind the last ray of each field, so that whole
//         vectors may be read and written at every ray. Integers are stored by their bits. The traced fields
//         come first and in the same order in every stream that is traced.
#ifndef KDRAY_LAYOUT_RAYS_H
#define KDRAY_LAYOUT_RAYS_H
#include "layout/base.layout.h"
#include "layout/features.h"

// Rays to a work-item of what shades and makes rays: a vector of them, or one where the device's own lanes
// are work-items. The host's capacities are for vectors.
#ifndef KDRAY_LANES
#define KDRAY_LANES 16u
#endif

// This is 1 in the kernels of ODPRT, whose rays carry what another queue needs to go on with them.
#ifndef KDRAY_ODPRT
#define KDRAY_ODPRT 0
#endif

// In scenes with footprints rays have a last field, u32: their cone (textures/ray_cone.clh). The host counts
// it by itself (host/engine/wavefront/slice_buffers.h).
#ifdef __OPENCL_C_VERSION__
#define KDRAY_RAY_CONE_FIELDS (KDRAY_HAS_FOOTPRINTS ? 1u : 0u)
#else
#define KDRAY_RAY_CONE_FIELDS 0u
#endif
// Where a scene has instances, rays, hits and shadow rays have a field more: what the host adds.
#if defined(KDRAY_HAS_INSTANCES) && KDRAY_HAS_INSTANCES
#define KDRAY_INSTANCE_FIELDS 1u
#else
#define KDRAY_INSTANCE_FIELDS 0u
#endif

// The traced fields: the ray origin + t*direction with t_min < t < t_max.
#define KDRAY_RAY_ORIGIN 0u  // x y z
// x y z; of unit length in a batch, from the origin to the light in a shadow stream.
#define KDRAY_RAY_DIRECTION 3u
#define KDRAY_RAY_T_MIN 6u
#define KDRAY_RAY_T_MAX 7u
// A batch: a ray that will add `weight` times what it finds to its pixel. All rays of a batch have one depth
// (Slice).
#define KDRAY_RAY_WEIGHT 8u  // red green blue
#define KDRAY_RAY_PIXEL 11u  // u32: row * width + column
// In ODPRT a ray brings the best hit so far, whose t is the float below t_max.
#define KDRAY_RAY_NUMBER 12u  // u32: of its primitive, in file order
#define KDRAY_RAY_FINDER 13u  // u32: KDRAY_FINDER of the part that holds it (or KDRAY_NO_PART)
#define KDRAY_RAY_WAY 14u     // a float, u32: the parts that were asked (odprt/way.clh)
// Where there are instances a ray has another word, the number in the whole scene of the one that the
// primitive is in + 1; last are its cone and its sample.
#define KDRAY_TRAVEL_RAY_FIELDS 16u
#if KDRAY_ODPRT
#define KDRAY_RAY_SKIP 0u  // none: a part may not know another's triangle
#define KDRAY_RAY_INSTANCE 16u
#define KDRAY_RAY_CONE (KDRAY_TRAVEL_RAY_FIELDS + KDRAY_INSTANCE_FIELDS)
#define KDRAY_RAY_SAMPLE (KDRAY_RAY_CONE + KDRAY_RAY_CONE_FIELDS)
#define KDRAY_RAY_FIELDS (KDRAY_RAY_SAMPLE + KDRAY_TELLS_SAMPLE)
#else
// u32: the reference that can't be hit (the triangle that the ray leaves), or MISS.
#define KDRAY_RAY_SKIP 12u
#define KDRAY_RAY_SKIP_INSTANCE 13u  // where there are instances: the one that the triangle is in
#define KDRAY_RAY_SAMPLE (13u + KDRAY_INSTANCE_FIELDS)
#define KDRAY_RAY_CONE (13u + KDRAY_INSTANCE_FIELDS + KDRAY_TELLS_SAMPLE)
#define KDRAY_RAY_FIELDS (13u + KDRAY_INSTANCE_FIELDS + KDRAY_TELLS_SAMPLE + KDRAY_RAY_CONE_FIELDS)
#endif
// With area lights a ray tells its pixel and sample: u32, 16 bits of the pixel's hash above the sample's
// number.
#ifdef __OPENCL_C_VERSION__
#define KDRAY_TELLS_SAMPLE (KDRAY_HAS_AREA_LIGHTS ? 1u : 0u)
#else
#define KDRAY_TELLS_SAMPLE 0u  // by the host: in scenes without
#endif

// The word of KDRAY_RAY_FINDER: the part that holds the best hit, in 12 bits; on the ray's way its depth in
// the 7 above and, from bit 19 on, the part that it goes to. For u32 and vectors of them. A ray that is there
// has the part alone.
#define KDRAY_FINDER(part, depth) ((part) | (depth) << 12)
#define KDRAY_FINDER_TO(word, to) ((word) | (to) << 19)
#define KDRAY_FINDER_PART(word) ((word)&4095u)
#define KDRAY_FINDER_DEPTH(word) ((word) >> 12 & 127u)
#define KDRAY_FINDER_GOES_TO(word) ((word) >> 19)

// Shadow rays: each adds `contribution` to its pixel unless something lies inside of its interval.
#define KDRAY_SHADOW_SKIP 8u  // u32: the reference that can't block (the triangle the point lies on), or MISS
#define KDRAY_SHADOW_CONTRIBUTION 9u                            // red green blue
#define KDRAY_SHADOW_PIXEL 12u                                  // u32
#define KDRAY_MADE_SHADOW_FIELDS (13u + KDRAY_INSTANCE_FIELDS)  // what shading writes
#define KDRAY_SHADOW_WAY 13u  // ODPRT, of those that come from elsewhere: as KDRAY_RAY_WAY
#define KDRAY_TRAVEL_SHADOW_FIELDS 15u
#define KDRAY_SENT_SHADOW_TO 15u  // on its way: the part that it goes to
#define KDRAY_SENT_SHADOW_FIELDS 16u
// The instance of the triangle, as for rays. In ODPRT it doesn't travel: no instance lies in two parts.
#if KDRAY_ODPRT
#define KDRAY_SHADOW_SKIP_INSTANCE KDRAY_TRAVEL_SHADOW_FIELDS
#define KDRAY_SHADOW_FIELDS (KDRAY_TRAVEL_SHADOW_FIELDS + KDRAY_INSTANCE_FIELDS)
#else
#define KDRAY_SHADOW_SKIP_INSTANCE 13u
#define KDRAY_SHADOW_FIELDS KDRAY_MADE_SHADOW_FIELDS
#endif
// The f-th field that shading writes.
#define KDRAY_MADE_SHADOW_FIELD(f) ((f) < 13u ? (f) : KDRAY_SHADOW_SKIP_INSTANCE)

// Pooled rays wait for their batch; they begin at t = 0 and have no end. Those of ODPRT may have come from
// elsewhere, and are kept as they are in a batch.
#define KDRAY_POOL_ORIGIN 0u
#define KDRAY_POOL_DIRECTION 3u
#if KDRAY_ODPRT
#define KDRAY_POOL_WEIGHT KDRAY_RAY_WEIGHT
#define KDRAY_POOL_PIXEL KDRAY_RAY_PIXEL
#define KDRAY_POOL_SAMPLE KDRAY_RAY_SAMPLE
#define KDRAY_POOL_FIELDS KDRAY_RAY_FIELDS
#else
#define KDRAY_POOL_WEIGHT 6u
#define KDRAY_POOL_PIXEL 9u
#define KDRAY_POOL_SKIP 10u
#define KDRAY_POOL_SKIP_INSTANCE 11u
#define KDRAY_POOL_SAMPLE (11u + KDRAY_INSTANCE_FIELDS)
#define KDRAY_POOL_FIELDS (11u + KDRAY_INSTANCE_FIELDS + KDRAY_TELLS_SAMPLE + KDRAY_RAY_CONE_FIELDS)
#endif
#if KDRAY_ODPRT
#define KDRAY_POOL_RAY_CONE KDRAY_RAY_CONE
#else
#define KDRAY_POOL_RAY_CONE (11u + KDRAY_INSTANCE_FIELDS + KDRAY_TELLS_SAMPLE)
#endif

// Hits of a batch, with the batch's capacity.
#define KDRAY_HIT_T 0u
#define KDRAY_HIT_REF 1u  // u32: kind and index (tree.layout.h), or KDRAY_REF_MISS, KDRAY_REF_INVALID
#define KDRAY_HIT_U 2u
#define KDRAY_HIT_V 3u
#define KDRAY_HIT_INSTANCE 4u  // u32: 1 + the instance's index, or 0
#define KDRAY_HIT_FIELDS (4u + KDRAY_INSTANCE_FIELDS)

// What became of each shadow ray, in one byte.
#define KDRAY_CLEAR 0u
#define KDRAY_OCCLUDED 1u
#define KDRAY_OCCLUSION_INVALID 2u  // the stack was too small

#define KDRAY_SPAN_INVALID 0xffffffffu

KDRAY_LAYOUT_BEGIN
// kdray::Ray and kdray::Hit of the public interface.
typedef struct QueryRay {
  float origin[3];
  float t_min;
  float direction[3];
  float t_max;
} QueryRay;
KDRAY_ASSERT_SIZE(QueryRay, 32)

typedef struct QueryHit {
  float t;
  i32 primitive;
  float u, v;
} QueryHit;
KDRAY_ASSERT_SIZE(QueryHit, 16)

// What a pass found of a ray's hits, and where the next begins: behind the hit at last_t (in the scene's own
// space) of primitive last_number.
typedef struct QuerySpan {
  u32 n_hits;  // or KDRAY_SPAN_INVALID
  u32 more;    // 0, or there are others behind: 1 + the last hit's instance, by index + 1
  float last_t;
  u32 last_number;
} QuerySpan;
KDRAY_ASSERT_SIZE(QuerySpan, 16)
KDRAY_LAYOUT_END
#endif
