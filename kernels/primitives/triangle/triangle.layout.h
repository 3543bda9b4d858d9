// What    Triangles of meshes as the kernels read them, about the scene's centre
//         (host/scene/model/geometry.h), and the rows of a block of them (layout/wide.layout.h).
#ifndef KDRAY_PRIMITIVES_TRIANGLE_TRIANGLE_LAYOUT_H
#define KDRAY_PRIMITIVES_TRIANGLE_TRIANGLE_LAYOUT_H
#include "layout/base.layout.h"
#include "layout/features.h"

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
  u32 normals;   // into the vertex normals, or KDRAY_NO_NORMALS; and KDRAY_ZERO_AREA, which always has some
} Triangle;
KDRAY_ASSERT_SIZE(Triangle, 48)
KDRAY_ASSERT_OFFSET(Triangle, number, 36)

typedef struct VertexNormals {
  float n[3][3];  // unit length
} VertexNormals;
KDRAY_ASSERT_SIZE(VertexNormals, 36)
KDRAY_LAYOUT_END

#define KDRAY_ROW_TRIANGLE_PX 0  // the corners p, q and r
#define KDRAY_ROW_TRIANGLE_PY 1
#define KDRAY_ROW_TRIANGLE_PZ 2
#define KDRAY_ROW_TRIANGLE_QX 3
#define KDRAY_ROW_TRIANGLE_QY 4
#define KDRAY_ROW_TRIANGLE_QZ 5
#define KDRAY_ROW_TRIANGLE_RX 6
#define KDRAY_ROW_TRIANGLE_RY 7
#define KDRAY_ROW_TRIANGLE_RZ 8
#define KDRAY_ROW_TRIANGLE_LIMIT \
  9  // |n|_1 + 8|edge|^2 for sign_limit (intersect.clh); < 0: lies across an axis; infinity: it has no area
#define KDRAY_ROW_TRIANGLE_INDEX 10
#define KDRAY_TRIANGLE_ROWS 11
#define KDRAY_TRIANGLE_IS_CURVED 0  // whether its test reads the square of the direction

#ifdef __OPENCL_C_VERSION__
#if KDRAY_HAS_KIND(TRIANGLE)
#define KDRAY_IF_TRIANGLE(code) code
#else
#define KDRAY_IF_TRIANGLE(code)
#endif
#endif

#endif
