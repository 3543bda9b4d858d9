// What    Ring tori as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_TORUS_TORUS_LAYOUT_H
#define KDRAY_PRIMITIVES_TORUS_TORUS_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

KDRAY_LAYOUT_BEGIN
// The points at minor_radius from a circle of major_radius about the centre, across the axis.
typedef struct Torus {
  float center[3];
  float major_radius;
  float axis[3];  // unit but for rounding
  float minor_radius;
  u32 number;
  u32 material;
  u32 pad[2];
} Torus;
KDRAY_ASSERT_SIZE(Torus, 48)
KDRAY_ASSERT_OFFSET(Torus, minor_radius, 28)
KDRAY_LAYOUT_END

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
#define KDRAY_TORUS_IS_CURVED 1  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(TORUS)
#define KDRAY_IF_TORUS(code) code
#else
#define KDRAY_IF_TORUS(code)
#endif
#endif

#endif
