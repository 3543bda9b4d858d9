// What    Rays, hits and shadow rays as they lie in a slice's buffers, and the rays and hits of `kdray trace`.
#ifndef KDRAY_LAYOUT_RAYS_H
#define KDRAY_LAYOUT_RAYS_H
#include "layout/base.layout.h"

KDRAY_LAYOUT_BEGIN
// A ray that will add `weight` times what it finds to its pixel. Its direction has unit length, its end is open.
typedef struct Ray {
  float origin[3];
  float t_min;
  float direction[3];
  u32 depth;  // the eye ray has 1
  float weight[3];
  u32 pixel;  // row * width + column
} Ray;
KDRAY_ASSERT_SIZE(Ray, 48)
KDRAY_ASSERT_OFFSET(Ray, depth, 28)

typedef struct Hit {
  float t;
  u32 ref;  // kind and index (tree.layout.h), or KDRAY_REF_MISS, KDRAY_REF_INVALID
  float u, v;
} Hit;
KDRAY_ASSERT_SIZE(Hit, 16)

// From a lit point to a light: adds `contribution` to its pixel unless something lies strictly between 0 and t_max.
typedef struct ShadowRay {
  float origin[3];
  float t_max;
  float direction[3];
  u32 skip;  // the reference that can't block (the triangle the point lies on), or KDRAY_REF_MISS
  float contribution[3];
  u32 pixel;
} ShadowRay;
KDRAY_ASSERT_SIZE(ShadowRay, 48)
KDRAY_ASSERT_OFFSET(ShadowRay, skip, 28)

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
KDRAY_LAYOUT_END
#endif
