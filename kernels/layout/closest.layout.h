// What    Points whose closest point of the scene is asked for, and the answers.
// Shape   A number is 64 bits: a double's, or, from a device without doubles, two floats that are to be added
//         (the lower 32 bits are the larger one); `form` tells which. All in the scene's own space
//         (host/base/local_space.h).
#ifndef KDRAY_LAYOUT_CLOSEST_H
#define KDRAY_LAYOUT_CLOSEST_H
#include "layout/base.layout.h"

#define KDRAY_FORM_DOUBLE 0u
#define KDRAY_FORM_TWO_FLOATS 1u

// Points beyond this, in local lengths, are asked from where their way to the scene's centre crosses it.
#define KDRAY_POINT_REACH 0x1p36f

KDRAY_LAYOUT_BEGIN
typedef struct QueryPoint {
  u64 place[3];  // doubles' bits
} QueryPoint;
KDRAY_ASSERT_SIZE(QueryPoint, 24)

typedef struct ClosestHit {
  u64 point[3];
  u64 distance;
  float u, v;  // weights of a triangle's second and third corner
  i32 number;  // of the primitive; KDRAY_CLOSEST_NONE, KDRAY_CLOSEST_INVALID
  u32 form;
} ClosestHit;
KDRAY_ASSERT_SIZE(ClosestHit, 48)
KDRAY_ASSERT_OFFSET(ClosestHit, number, 40)
KDRAY_LAYOUT_END

#define KDRAY_CLOSEST_NONE -1     // nothing within the radius
#define KDRAY_CLOSEST_INVALID -2  // a leaf of a kind that the program doesn't have
#endif
