// What    Materials and lights as the kernels read them; meanings as in host/scene/model/scene.h.
#ifndef KDRAY_LAYOUT_SHADING_H
#define KDRAY_LAYOUT_SHADING_H
#include "layout/base.layout.h"

#define KDRAY_NO_MAPS 0xffffffffu

#define KDRAY_LIGHT_POINT 0u
#define KDRAY_LIGHT_DIRECTIONAL 1u
#define KDRAY_LIGHT_SPOT 2u
#define KDRAY_LIGHT_RECTANGLE 3u
#define KDRAY_LIGHT_SPHERE 4u
#define KDRAY_LIGHT_DISC 5u

KDRAY_LAYOUT_BEGIN
typedef struct Material {
  float unshadowed[3];  // emission + ambient * Camb
  float diffuse[3];
  float specular[3];
  float reflect[3];
  float transmit[3];
  float shine;
  float index;
  u32 maps;  // into the material maps (textures.layout.h), or KDRAY_NO_MAPS
  u32 pad[2];
} Material;
KDRAY_ASSERT_SIZE(Material, 80)
KDRAY_ASSERT_OFFSET(Material, shine, 60)
KDRAY_ASSERT_OFFSET(Material, maps, 68)

typedef struct Light {
  float position[3];
  u32 kind;
  float direction[3];  // the way the light travels, unit
  float range;
  float color[3];
  float cos_inner;
  float attenuation[3];
  float cos_outer;
  // Half of a rectangle's edges, or two of a disc's radii at right angles. (0: it has none.)
  float across[3];
  float radius;  // a sphere's
  float down[3];
  u32 pad;
} Light;
KDRAY_ASSERT_SIZE(Light, 96)
KDRAY_ASSERT_OFFSET(Light, cos_outer, 60)
KDRAY_LAYOUT_END
#endif
