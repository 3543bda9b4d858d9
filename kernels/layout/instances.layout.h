// What    Instances of meshes: where a mesh lies in the scene, as rays and surfaces need it.
// Shape   A mesh has a space of its own, as large as a scene's (host/base/local_space.h), and its own subtree
//         of the wide form, whose root is `root`; its primitives lie in the scene's arrays, behind the
//         scene's own.
//             in the mesh  = to_mesh * (in the scene - place) + mesh_place
//             in the scene = to_world * (in the mesh - mesh_place) + place
//         `place` is about the middle of the instance, as floats; `mesh_place` is where that lies in the
//         mesh. So what is near the instance keeps its bits, wherever in the scene it is. A child of a wide
//         node that is an instance is KDRAY_WIDE_LEAF | KDRAY_KIND_INSTANCE << KDRAY_WIDE_KIND_SHIFT | its
//         index. Rays and hits name an instance by index + 1; 0 is the scene itself. Behind all instances lie
//         pieces of some (host/accel/flatten/instance_openings.h), the same but for `root`, which is a node
//         below the mesh's: they are leaves of the tree over instances, and the whole instance names their
//         hits.
// Errors  All are rounded once from double. host/accel/flatten/instances.h has the bounds that follow.
#ifndef KDRAY_LAYOUT_INSTANCES_H
#define KDRAY_LAYOUT_INSTANCES_H
#include "layout/base.layout.h"
#include "layout/wide.layout.h"

// The kind of a leaf that is an instance: it differs from primitives' kinds and from KDRAY_REF_NO_KIND.
#define KDRAY_KIND_INSTANCE 14u
#define KDRAY_INSTANCE_LEAF (KDRAY_WIDE_LEAF | KDRAY_KIND_INSTANCE << KDRAY_WIDE_KIND_SHIFT)
#define KDRAY_MESH_MATERIAL 0xffffffffu

KDRAY_LAYOUT_BEGIN
typedef struct Instance {
  // What a walk reads.
  float to_mesh[3][3];  // by rows
  float place[3];
  float mesh_place[3];
  float reach;  // largest |coordinate| in the mesh
  u32 root;     // of the mesh, among the wide nodes
  // What surfaces read besides.
  float to_world[3][3];  // by rows
  u32 material;          // of all its primitives, or KDRAY_MESH_MATERIAL: each has its own
  u32 number;            // its place in the scene's list; in ODPRT's parts among all that can be hit
  u32 whole;             // its index; a piece's: that of the instance
  u32 pad[3];
} Instance;
KDRAY_ASSERT_SIZE(Instance, 128)
KDRAY_ASSERT_OFFSET(Instance, to_world, 68)
typedef char kdray_kinds_below_instances[KDRAY_N_KINDS <= KDRAY_KIND_INSTANCE ? 1 : -1];
KDRAY_LAYOUT_END
#endif
