// What    Spheres as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_SPHERE_SPHERE_LAYOUT_H
#define KDRAY_PRIMITIVES_SPHERE_SPHERE_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

KDRAY_LAYOUT_BEGIN
typedef struct Sphere {
  float center[3];
  float radius;
  u32 number;
  u32 material;
  u32 pad[2];
} Sphere;
KDRAY_ASSERT_SIZE(Sphere, 32)
KDRAY_LAYOUT_END

#define KDRAY_ROW_SPHERE_X 0  // the centre
#define KDRAY_ROW_SPHERE_Y 1
#define KDRAY_ROW_SPHERE_Z 2
#define KDRAY_ROW_SPHERE_RADIUS 3
#define KDRAY_ROW_SPHERE_INDEX 4
#define KDRAY_SPHERE_ROWS 5
#define KDRAY_SPHERE_IS_CURVED 1  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(SPHERE)
#define KDRAY_IF_SPHERE(code) code
#else
#define KDRAY_IF_SPHERE(code)
#endif
#endif

#endif
