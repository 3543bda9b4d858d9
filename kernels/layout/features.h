// What    The feature mask: what a scene needs. The host ORs it together (host/flatten/features.h) and passes
//         it as KDRAY_FEATURES; here it becomes KDRAY_HAS_X = 0 or 1, to be tested with #if. Undefined:
//         everything on, so that each kernel compiles alone. Bits between those below are the rules'
//         (rules.h).
#ifndef KDRAY_LAYOUT_FEATURES_H
#define KDRAY_LAYOUT_FEATURES_H
#include "layout/rules.h"

// Geometry, bits 0-7: set by the primitives that are there; removes their tests, fields and shading.
#define KDRAY_FEATURE_TRIANGLES 0x00000001u
#define KDRAY_FEATURE_SPHERES 0x00000002u
#define KDRAY_FEATURE_CONES 0x00000004u
#define KDRAY_FEATURE_SMOOTH 0x00000008u  // vertex normals; removes interpolation and the terminator's shift
// Numbers in file order that differ from indices; removes looking them up.
#define KDRAY_FEATURE_NUMBERS 0x00000010u
// Materials, bits 8-15.
#define KDRAY_FEATURE_REFLECT 0x00000100u   // removes reflected rays (and, with TRANSMIT, the pool)
#define KDRAY_FEATURE_TRANSMIT 0x00000200u  // removes refracted rays
#define KDRAY_FEATURE_SPECULAR 0x00000400u  // removes highlights
#define KDRAY_FEATURE_DIFFUSE 0x00000800u   // removes the diffuse term
// Lights, bits 16-23.
#define KDRAY_FEATURE_LIGHTS 0x00010000u       // removes shadow rays, their buffers and launches
#define KDRAY_FEATURE_ATTENUATION 0x00020000u  // removes fall-off and range
#define KDRAY_FEATURE_DIRECTIONAL 0x00040000u
#define KDRAY_FEATURE_SPOT 0x00080000u
// A core with faces around it; removes looking whether rays pass it by.
#define KDRAY_FEATURE_FACES 0x00400000u
// Film, bits 24-27.
#define KDRAY_FEATURE_BACKGROUND 0x01000000u   // a background other than black
#define KDRAY_FEATURE_SUPERSAMPLE 0x02000000u  // more than one sample per pixel
#define KDRAY_FEATURE_ADAPTIVE 0x04000000u     // rounds of single samples beside whole tiles
// Debug, bits 28-31.
#define KDRAY_FEATURE_COST 0x10000000u  // counts nodes and tests per ray, for the cost channel

#ifdef __OPENCL_C_VERSION__
#ifndef KDRAY_FEATURES
#define KDRAY_FEATURES (~KDRAY_KEEP_ALL)
#endif
#define KDRAY_HAS_TRIANGLES ((KDRAY_FEATURES & KDRAY_FEATURE_TRIANGLES) != 0)
#define KDRAY_HAS_SPHERES ((KDRAY_FEATURES & KDRAY_FEATURE_SPHERES) != 0)
#define KDRAY_HAS_CONES ((KDRAY_FEATURES & KDRAY_FEATURE_CONES) != 0)
#define KDRAY_HAS_SMOOTH ((KDRAY_FEATURES & KDRAY_FEATURE_SMOOTH) != 0)
#define KDRAY_HAS_NUMBERS ((KDRAY_FEATURES & KDRAY_FEATURE_NUMBERS) != 0)
#define KDRAY_HAS_REFLECT ((KDRAY_FEATURES & KDRAY_FEATURE_REFLECT) != 0)
#define KDRAY_HAS_TRANSMIT ((KDRAY_FEATURES & KDRAY_FEATURE_TRANSMIT) != 0)
#define KDRAY_HAS_SPECULAR ((KDRAY_FEATURES & KDRAY_FEATURE_SPECULAR) != 0)
#define KDRAY_HAS_DIFFUSE ((KDRAY_FEATURES & KDRAY_FEATURE_DIFFUSE) != 0)
#define KDRAY_HAS_LIGHTS ((KDRAY_FEATURES & KDRAY_FEATURE_LIGHTS) != 0)
#define KDRAY_HAS_ATTENUATION ((KDRAY_FEATURES & KDRAY_FEATURE_ATTENUATION) != 0)
#define KDRAY_HAS_DIRECTIONAL ((KDRAY_FEATURES & KDRAY_FEATURE_DIRECTIONAL) != 0)
#define KDRAY_HAS_SPOT ((KDRAY_FEATURES & KDRAY_FEATURE_SPOT) != 0)
#define KDRAY_HAS_FACES ((KDRAY_FEATURES & KDRAY_FEATURE_FACES) != 0)
#define KDRAY_HAS_BACKGROUND ((KDRAY_FEATURES & KDRAY_FEATURE_BACKGROUND) != 0)
#define KDRAY_HAS_SUPERSAMPLE ((KDRAY_FEATURES & KDRAY_FEATURE_SUPERSAMPLE) != 0)
#define KDRAY_HAS_ADAPTIVE ((KDRAY_FEATURES & KDRAY_FEATURE_ADAPTIVE) != 0)
#define KDRAY_HAS_COST ((KDRAY_FEATURES & KDRAY_FEATURE_COST) != 0)
#endif
#endif
