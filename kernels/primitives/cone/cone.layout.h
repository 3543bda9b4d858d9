// What    Cones as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_CONE_CONE_LAYOUT_H
#define KDRAY_PRIMITIVES_CONE_CONE_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

KDRAY_LAYOUT_BEGIN
// The points base + s*axis + (base_radius + slope*s)*n, 0 <= s <= height, n unit and at right angles to the
// axis.
typedef struct Cone {
  float base[3];
  float base_radius;
  float axis[3];  // unit
  float height;
  float slope;  // (apex radius - base radius) / height
  u32 number;
  u32 material;
  u32 pad;
} Cone;
KDRAY_ASSERT_SIZE(Cone, 48)
KDRAY_ASSERT_OFFSET(Cone, height, 28)
KDRAY_LAYOUT_END

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
#define KDRAY_CONE_IS_CURVED 1  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(CONE)
#define KDRAY_IF_CONE(code) code
#else
#define KDRAY_IF_CONE(code)
#endif
#endif

#endif
