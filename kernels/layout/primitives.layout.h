// What    Primitives of all kinds as the kernels read them. One line for each kind.
#ifndef KDRAY_LAYOUT_PRIMITIVES_H
#define KDRAY_LAYOUT_PRIMITIVES_H
#include "primitives/capsule/capsule.layout.h"
#include "primitives/cone/cone.layout.h"
#include "primitives/disc/disc.layout.h"
#include "primitives/sphere/sphere.layout.h"
#include "primitives/torus/torus.layout.h"
#include "primitives/triangle/triangle.layout.h"

#define KDRAY_CURVED_KIND(NAME, name, names, Struct) || (KDRAY_HAS_KIND(NAME) && KDRAY_##NAME##_IS_CURVED)
#define KDRAY_HAS_CURVED (0 KDRAY_KINDS(KDRAY_CURVED_KIND))

#endif
