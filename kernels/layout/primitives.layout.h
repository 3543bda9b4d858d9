// What    Primitives as the kernels read them, about the scene's centre (host/scene/model/geometry.h).
#ifndef KDRAY_LAYOUT_PRIMITIVES_H
#define KDRAY_LAYOUT_PRIMITIVES_H
#include "layout/base.layout.h"

// Triangle::normals: the index, and the bit of a zero-area triangle, whose corners differ but lie on one
// line: it has no plane, but closes what would gape where a corner lies on a neighbour's edge.
#define KDRAY_NO_NORMALS 0x7fffffffu
#define KDRAY_NORMALS_MASK 0x7fffffffu
#define KDRAY_ZERO_AREA 0x80000000u

KDRAY_LAYOUT_BEGIN
typedef struct Triangle {
  float v[3][3];
  u32 number;    // place in file order
  u32 material;  // into materials
  u32 normals;   // into the vertex normals, or KDRAY_NO_NORMALS; and KDRAY_STITCH, which always has some
} Triangle;
KDRAY_ASSERT_SIZE(Triangle, 48)
KDRAY_ASSERT_OFFSET(Triangle, number, 36)

typedef struct VertexNormals {
  float n[3][3];  // unit length
} VertexNormals;
KDRAY_ASSERT_SIZE(VertexNormals, 36)

typedef struct Sphere {
  float center[3];
  float radius;
  u32 number;
  u32 material;
  u32 pad[2];
} Sphere;
KDRAY_ASSERT_SIZE(Sphere, 32)

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
#endif
