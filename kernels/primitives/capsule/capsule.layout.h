// What    Capsules as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_CAPSULE_CAPSULE_LAYOUT_H
#define KDRAY_PRIMITIVES_CAPSULE_CAPSULE_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

KDRAY_LAYOUT_BEGIN
// The points at `radius` from the segment that reaches half_length to both sides of the centre.
typedef struct Capsule {
  float center[3];
  float half_length;
  float axis[3];  // unit but for rounding
  float radius;
  u32 number;
  u32 material;
  u32 pad[2];
} Capsule;
KDRAY_ASSERT_SIZE(Capsule, 48)
KDRAY_ASSERT_OFFSET(Capsule, radius, 28)
KDRAY_LAYOUT_END

#define KDRAY_ROW_CAPSULE_X 0  // the centre
#define KDRAY_ROW_CAPSULE_Y 1
#define KDRAY_ROW_CAPSULE_Z 2
#define KDRAY_ROW_CAPSULE_AXIS_X 3
#define KDRAY_ROW_CAPSULE_AXIS_Y 4
#define KDRAY_ROW_CAPSULE_AXIS_Z 5
#define KDRAY_ROW_CAPSULE_HALF 6
#define KDRAY_ROW_CAPSULE_RADIUS 7
#define KDRAY_ROW_CAPSULE_INDEX 8
#define KDRAY_CAPSULE_ROWS 9
#define KDRAY_CAPSULE_IS_CURVED 1  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(CAPSULE)
#define KDRAY_IF_CAPSULE(code) code
#else
#define KDRAY_IF_CAPSULE(code)
#endif
#endif

#endif
