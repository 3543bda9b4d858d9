// What    The kinds of primitives, read by the host and the kernels: arrays, buffers, dispatch, counts and
//         the sections of files follow from this list. docs/add-a-primitive.md leads through adding a kind.
// Shape   KDRAY_KINDS(X) is X(NAME, name, names, Struct) for each kind, in the order of their numbers;
//         KDRAY_KINDS_WITH hands another macro on as well. A triangle is part of a mesh; the shapes stand for
//         themselves. A kind with the number KDRAY_KIND_X has a struct and, in a block of the wide form,
//         KDRAY_X_ROWS rows of KDRAY_BLOCK words, the last of them the index (primitives/x/x.layout.h); and
//         it has a bit of the feature mask (features.h).
#ifndef KDRAY_LAYOUT_KINDS_H
#define KDRAY_LAYOUT_KINDS_H

#define KDRAY_SHAPES_WITH(F, X)         \
  F(X, SPHERE, sphere, spheres, Sphere) \
  F(X, CONE, cone, cones, Cone)         \
  F(X, DISC, disc, discs, Disc)         \
  F(X, TORUS, torus, tori, Torus)       \
  F(X, CAPSULE, capsule, capsules, Capsule)

#define KDRAY_KINDS_WITH(F, X)                  \
  F(X, TRIANGLE, triangle, triangles, Triangle) \
  KDRAY_SHAPES_WITH(F, X)

#define KDRAY_KINDS(X) KDRAY_KINDS_WITH(KDRAY_KIND_ALONE, X)
#define KDRAY_SHAPES(X) KDRAY_SHAPES_WITH(KDRAY_KIND_ALONE, X)
#define KDRAY_KIND_ALONE(X, NAME, name, names, Struct) X(NAME, name, names, Struct)

// Numbers that the preprocessor can compute with.
#define KDRAY_KIND_TRIANGLE 0u
#define KDRAY_KIND_SPHERE 1u
#define KDRAY_KIND_CONE 2u
#define KDRAY_KIND_DISC 3u
#define KDRAY_KIND_TORUS 4u
#define KDRAY_KIND_CAPSULE 5u

#define KDRAY_COUNT_KIND(NAME, name, names, Struct) +1
#define KDRAY_N_KINDS (0u KDRAY_KINDS(KDRAY_COUNT_KIND))

// Lists of names, each followed by a comma: of a kind's array, and of its blocks'.
#define KDRAY_KIND_PLURAL(NAME, name, names, Struct) names,
#define KDRAY_KIND_BLOCKS(NAME, name, names, Struct) name##_blocks,

// The numbers are the places in the list.
#define KDRAY_PLACE_OF_KIND(NAME, name, names, Struct) KDRAY_PLACE_OF_##NAME,
enum KdrayKindPlaces { KDRAY_KINDS(KDRAY_PLACE_OF_KIND) };
#define KDRAY_CHECK_KIND(NAME, name, names, Struct) \
  typedef char kdray_kind_number_of_##name[KDRAY_KIND_##NAME == (unsigned)KDRAY_PLACE_OF_##NAME ? 1 : -1];
KDRAY_KINDS(KDRAY_CHECK_KIND)

#endif
