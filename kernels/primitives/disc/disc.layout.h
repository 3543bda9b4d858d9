// What    Flat discs as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_DISC_DISC_LAYOUT_H
#define KDRAY_PRIMITIVES_DISC_DISC_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

KDRAY_LAYOUT_BEGIN
// In the plane through its centre at right angles to the normal, which is of unit length but for rounding.
typedef struct Disc {
  float center[3];
  float radius;
  float normal[3];
  u32 number;
  u32 material;
  u32 pad[3];
} Disc;
KDRAY_ASSERT_SIZE(Disc, 48)
KDRAY_ASSERT_OFFSET(Disc, number, 28)
KDRAY_LAYOUT_END

#define KDRAY_ROW_DISC_X 0  // the centre
#define KDRAY_ROW_DISC_Y 1
#define KDRAY_ROW_DISC_Z 2
#define KDRAY_ROW_DISC_NORMAL_X 3
#define KDRAY_ROW_DISC_NORMAL_Y 4
#define KDRAY_ROW_DISC_NORMAL_Z 5
#define KDRAY_ROW_DISC_RADIUS 6
#define KDRAY_ROW_DISC_INDEX 7
#define KDRAY_DISC_ROWS 8
#define KDRAY_DISC_IS_CURVED 0  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(DISC)
#define KDRAY_IF_DISC(code) code
#else
#define KDRAY_IF_DISC(code)
#endif
#endif

#endif
