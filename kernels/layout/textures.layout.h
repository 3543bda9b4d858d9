// What    What pictures and colours at corners make of materials: material maps, textures, and what triangles
//         have at their corners; meanings as in host/scene/textures/texturing.h.
// Shape   Texels are words, red in the lowest byte, then green, blue, alpha. The first KDRAY_TEXEL_CURVE of
//         them are no texels but sRGB's curve: for each code of a byte what it is worth, in 65535ths.
#ifndef KDRAY_LAYOUT_TEXTURES_H
#define KDRAY_LAYOUT_TEXTURES_H
#include "layout/base.layout.h"

#define KDRAY_NO_TEXTURE 0xffffffffu
#define KDRAY_TEXEL_CURVE 256u

// Texture::how. How coordinates beyond the picture are meant, along each axis.
#define KDRAY_WRAP_REPEAT 0u
#define KDRAY_WRAP_MIRROR 1u
#define KDRAY_WRAP_CLAMP 2u
#define KDRAY_WRAP_ACROSS(how) ((how)&3u)
#define KDRAY_WRAP_DOWN(how) ((how) >> 2 & 3u)
#define KDRAY_TEXTURE_NEAREST 16u                 // one texel; else four, by how near they are
#define KDRAY_TEXTURE_CURVED 32u                  // red, green and blue are codes of sRGB; else linear
#define KDRAY_TEXTURE_SET(how) ((how) >> 6 & 1u)  // of the coordinates at a triangle's corners
// How many sets triangles have, one behind the other; the last one may be tangents.
#define KDRAY_TEXTURE_SETS(how) (((how) >> 7 & 1u) + ((how) >> 11 & 1u) + 1)
#define KDRAY_TEXTURE_TANGENTS 2048u

// How it is looked up where it is shown smaller than it is, and how its mipmaps take part.
#define KDRAY_TEXTURE_MIN_NEAREST 256u
#define KDRAY_TEXTURE_MIPMAPS 512u      // it has some; else only the picture itself is looked at
#define KDRAY_TEXTURE_MIP_LINEAR 1024u  // two of them are mixed; else the nearer one is taken
// The most places along a footprint at which a texture is looked up.
#define KDRAY_MOST_PROBES 8u

// MaterialMaps::how.
#define KDRAY_MAPS_COLORED 1u    // triangles have colours at their corners
#define KDRAY_MAPS_MASK 2u       // nothing is there where alpha is below the cutoff
#define KDRAY_MAPS_BLEND 4u      // the share 1 - alpha goes through
#define KDRAY_MAPS_METAL 8u      // its terms follow from how metallic and rough the place is (see below)
#define KDRAY_MAPS_TANGENTS 16u  // triangles have tangents at their corners, for the picture of normals

// A corner's tangent: a unit vector on an unfolded octahedron. This is added to its second number, and the
// sum is negative where the picture is mirrored. 0, 0: none.
#define KDRAY_TANGENT_OFFSET 2.0f

// The ambient light that metal by maps counts with, and the strength of a smooth dielectric's highlight.
#define KDRAY_METAL_AMBIENT 0.1f
#define KDRAY_METAL_HIGHLIGHT 0.25f

KDRAY_LAYOUT_BEGIN
// At (u, v) of a triangle the picture is looked at across[0]*u + across[1]*v + across[2] of its width from
// the left, and the same with `down` of its height from the top.
typedef struct Texture {
  float across[3], down[3];
  u32 first;  // texel of the top row
  u32 width, height;
  u32 how;
  // Forms of it, each half as wide and as high as the one before, rounded down, but one at least; they lie
  // one behind the other.
  u32 n_levels;
  u32 pad;
} Texture;
KDRAY_ASSERT_SIZE(Texture, 48)
KDRAY_ASSERT_OFFSET(Texture, first, 24)

// These terms, times the base colour, are added to those of the material.
typedef struct MaterialMaps {
  float unshadowed[3];
  float diffuse[3];
  float specular[3];
  float reflect[3];
  float transmit[3];
  float alpha;
  float cutoff;
  u32 base;  // into the textures, or KDRAY_NO_TEXTURE; and so are the other maps
  u32 how;
  u32 normal_map;
  // By light maps: emission is `emissive` times a map's colour; `ambient` times the base colour, less what
  // occlusion takes, is added to what is unshadowed; highlights and mirrors are multiplied by a map's colour
  // instead of the base colour.
  u32 emission_map, occlusion_map, highlight_map;
  float occlusion;  // its strength
  float emissive[3];
  float normal_scale;
  float ambient[3];
  // Of metal: the base colour's factor and those of the map, whose green is rough and whose blue is metallic.
  float metallic;
  float base_color[3];
  float roughness;
  float transmission;  // the share of the dielectric's base colour that goes through
  float mirrored;      // the share of that which a smooth surface reflects
  u32 metal_map;
  u32 pad;
} MaterialMaps;
KDRAY_ASSERT_SIZE(MaterialMaps, 160)
KDRAY_ASSERT_OFFSET(MaterialMaps, alpha, 60)
KDRAY_ASSERT_OFFSET(MaterialMaps, metallic, 124)

// Colours of a triangle's corners, linear, in 65535ths: red and in the upper half green, then blue and alpha.
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
