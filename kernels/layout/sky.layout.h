// What    A background by direction, as the kernels read it: colours by height, or a picture all around;
//         meanings as in host/scene/textures/sky.h.
// Shape   Colours are floats in `sky_colors`. A gradient: a base colour, and behind it `width` steps of six,
//         each the height where it begins, 1 over its height, and what it adds; the sixth is 0. A picture:
//         red, green and blue of `width` times `height` texels, row by row from the top.
#ifndef KDRAY_LAYOUT_SKY_H
#define KDRAY_LAYOUT_SKY_H
#include "layout/base.layout.h"

#define KDRAY_SKY_GRADIENT 0u
#define KDRAY_SKY_PICTURE 1u
#define KDRAY_SKY_STEP 6u          // floats
#define KDRAY_SKY_MOST 1048576.0f  // of a picture: what the film cuts contributions at (frame.layout.h)

KDRAY_LAYOUT_BEGIN
// The picture's middle lies in the direction `forward`, its right half towards `right`.
typedef struct Sky {
  float right[3];
  u32 kind;
  float up[3];
  u32 width;
  float forward[3];
  u32 height;
} Sky;
KDRAY_ASSERT_SIZE(Sky, 48)
KDRAY_ASSERT_OFFSET(Sky, forward, 32)
KDRAY_LAYOUT_END
#endif
