// What    What pictures and colours at corners make of materials: coats, textures, and what triangles have at
//         their corners; meanings as in host/scene/paint.h.
// Shape   Texels are words, red in the lowest byte, then green, blue, alpha. The first KDRAY_TEXEL_CURVE of
//         them are no texels but sRGB's curve: for each code of a byte what it is worth, in 65535ths.
#ifndef KDRAY_LAYOUT_PAINT_H
#define KDRAY_LAYOUT_PAINT_H
#include "layout/base.layout.h"

#define KDRAY_NO_TEXTURE 0xffffffffu
#define KDRAY_TEXEL_CURVE 256u

// Texture::how. How coordinates beyond the picture are meant, along each axis.
#define KDRAY_WRAP_REPEAT 0u
#define KDRAY_WRAP_MIRROR 1u
#define KDRAY_WRAP_CLAMP 2u
#define KDRAY_WRAP_ACROSS(how) ((how)&3u)
#define KDRAY_WRAP_DOWN(how) ((how) >> 2 & 3u)
#define KDRAY_TEXTURE_NEAREST 16u                        // one texel; else four, by how near they are
#define KDRAY_TEXTURE_CURVED 32u                         // red, green and blue are codes of sRGB; else linear
#define KDRAY_TEXTURE_SET(how) ((how) >> 6 & 1u)         // of the coordinates at a triangle's corners
#define KDRAY_TEXTURE_SETS(how) (((how) >> 7 & 1u) + 1)  // that triangles have, one behind the other

// Coat::how.
#define KDRAY_COAT_COLORED 1u  // triangles have colours at their corners
#define KDRAY_COAT_MASK 2u     // nothing is there where alpha is below the cutoff
#define KDRAY_COAT_BLEND 4u    // the share 1 - alpha goes through

KDRAY_LAYOUT_BEGIN
// At (u, v) of a triangle the picture is looked at across[0]*u + across[1]*v + across[2] of its width from
// the left, and the same with `down` of its height from the top.
typedef struct Texture {
  float across[3], down[3];
  u32 first;  // texel of the top row
  u32 width, height;
  u32 how;
  u32 pad[2];
} Texture;
KDRAY_ASSERT_SIZE(Texture, 48)
KDRAY_ASSERT_OFFSET(Texture, first, 24)

// These terms, times the base colour, are added to those of the material.
typedef struct Coat {
  float unshadowed[3];
  float diffuse[3];
  float specular[3];
  float reflect[3];
  float transmit[3];
  float alpha;
  float cutoff;
  u32 base;  // into the textures, or KDRAY_NO_TEXTURE
  u32 how;
  u32 pad;
} Coat;
KDRAY_ASSERT_SIZE(Coat, 80)
KDRAY_ASSERT_OFFSET(Coat, alpha, 60)

// Of a triangle's corners, linear, in 65535ths: red and in the upper half green, then blue and alpha.
typedef struct CornerColors {
  u32 c[3][2];
} CornerColors;
KDRAY_ASSERT_SIZE(CornerColors, 24)

typedef struct TexCoords {
  float uv[3][2];
} TexCoords;
KDRAY_ASSERT_SIZE(TexCoords, 24)
KDRAY_LAYOUT_END
#endif
