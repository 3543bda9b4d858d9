// What    Where the rays that leave a hit begin, as `kdray verify` asks the shading code for it.
#ifndef KDRAY_LAYOUT_VERIFY_H
#define KDRAY_LAYOUT_VERIFY_H
#include "layout/base.layout.h"

KDRAY_LAYOUT_BEGIN
typedef struct KnownHit {
  float t;
  u32 ref;  // as in a stream of hits
  float u, v;
} KnownHit;
KDRAY_ASSERT_SIZE(KnownHit, 16)

typedef struct Departure {
  float front[3];   // origin of reflected and shadow rays
  float back[3];    // origin of refracted rays
  float normal[3];  // geometric, unit, towards the side the ray came from
  u32 pad;
} Departure;
KDRAY_ASSERT_SIZE(Departure, 40)
KDRAY_LAYOUT_END
#endif
