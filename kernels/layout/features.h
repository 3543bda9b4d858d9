// What    The feature mask: what a scene needs. The host ORs it together (host/accel/flatten/features.h) and
//         passes it as KDRAY_FEATURES; here it becomes KDRAY_HAS_X = 0 or 1, to be tested with #if. Where
//         that is undefined everything is on, so that each kernel compiles alone.
// Shape   64 bits, 16 for each of four groups: the rules that are off (rules.h), the kinds of primitives
//         (kinds.h), what surfaces need, what light and film need. Bits that have no name here are free.
#ifndef KDRAY_LAYOUT_FEATURES_H
#define KDRAY_LAYOUT_FEATURES_H
#include "layout/base.layout.h"
#include "layout/kinds.h"
#include "layout/rules.h"

#define KDRAY_FEATURE(bit) (1ul << (bit))

// Kinds of primitives, bits 16-31: set by those that are there; removes their tests, fields and shading.
#define KDRAY_FEATURE_OF_KIND(number) KDRAY_FEATURE(16u + (number))
#define KDRAY_FEATURE_KIND(NAME) KDRAY_FEATURE_OF_KIND(KDRAY_KIND_##NAME)
#define KDRAY_FEATURE_ALL_KINDS 0xffff0000ul
// Surfaces, bits 32-47.
#define KDRAY_FEATURE_SMOOTH \
  KDRAY_FEATURE(32)  // vertex normals; removes interpolation, the terminator's shift
// Zero-area triangles (primitives.layout.h), which have vertex normals; removes their distance and shading.
#define KDRAY_FEATURE_ZERO_AREA KDRAY_FEATURE(34)
// Numbers in file order that differ from indices; removes looking them up.
#define KDRAY_FEATURE_NUMBERS KDRAY_FEATURE(33)
// Rays and primitives of queries that meet only where their masks have a bit in common; removes looking at
// them.
#define KDRAY_FEATURE_MASKS KDRAY_FEATURE(35)
// Materials with maps (textures.layout.h); removes all of it from shading, and the next three with it.
#define KDRAY_FEATURE_MATERIAL_MAPS KDRAY_FEATURE(36)
#define KDRAY_FEATURE_CORNER_COLORS KDRAY_FEATURE(37)
#define KDRAY_FEATURE_TEXTURES KDRAY_FEATURE(38)
// Material maps with holes in them; removes looking for holes from the walks.
#define KDRAY_FEATURE_CUTOUTS KDRAY_FEATURE(39)
#define KDRAY_FEATURE_REFLECT KDRAY_FEATURE(40)   // removes reflected rays (and, with TRANSMIT, the pool)
#define KDRAY_FEATURE_TRANSMIT KDRAY_FEATURE(41)  // removes refracted rays
#define KDRAY_FEATURE_SPECULAR KDRAY_FEATURE(42)  // removes highlights
#define KDRAY_FEATURE_DIFFUSE KDRAY_FEATURE(43)   // removes the diffuse term
// A background by direction (sky.layout.h) beside that of one colour; removes looking it up.
#define KDRAY_FEATURE_SKY KDRAY_FEATURE(44)
// Lights with an area; removes choosing a place on them, and the word by which rays tell their sample.
#define KDRAY_FEATURE_AREA_LIGHTS KDRAY_FEATURE(45)
#define KDRAY_FEATURE_LENS KDRAY_FEATURE(46)  // removes choosing a place on the camera's lens
// Queries of a scene of doubles (primitives/triangle/filter.clh); removes doubt from hits.
#define KDRAY_FEATURE_FILTER KDRAY_FEATURE(47)
// What makes a pixel's samples differ even where the picture is uniform.
#define KDRAY_FEATURES_NOISY (KDRAY_FEATURE_AREA_LIGHTS | KDRAY_FEATURE_LENS)
// Light, bits 48-55, and film, bits 56-63.
#define KDRAY_FEATURE_LIGHTS KDRAY_FEATURE(48)       // removes shadow rays, their buffers and launches
#define KDRAY_FEATURE_ATTENUATION KDRAY_FEATURE(49)  // removes fall-off and range
#define KDRAY_FEATURE_DIRECTIONAL KDRAY_FEATURE(50)
#define KDRAY_FEATURE_SPOT KDRAY_FEATURE(51)
// A core with faces around it; removes testing whether rays pass it by.
#define KDRAY_FEATURE_FACES KDRAY_FEATURE(52)
// A floor that rays see which meet nothing else (shade/floor.clh); removes looking for it.
#define KDRAY_FEATURE_FLOOR KDRAY_FEATURE(54)
// Instances of meshes (instances.layout.h); removes walks and surfaces in other spaces, and the instance from
// rays and hits.
#define KDRAY_FEATURE_INSTANCES KDRAY_FEATURE(53)
#define KDRAY_FEATURE_BACKGROUND KDRAY_FEATURE(56)   // a background other than black
#define KDRAY_FEATURE_SUPERSAMPLE KDRAY_FEATURE(57)  // more than one sample per pixel
#define KDRAY_FEATURE_ADAPTIVE KDRAY_FEATURE(58)     // rounds of single samples beside whole tiles
// More of surfaces. Textures that are shown smaller otherwise than larger; removes ray cones and mipmaps.
#define KDRAY_FEATURE_FOOTPRINTS KDRAY_FEATURE(59)
// Pictures of how metallic and rough surfaces are, of normals, and of emission, occlusion and highlights;
// each removes looking for them.
#define KDRAY_FEATURE_METAL_MAPS KDRAY_FEATURE(60)
#define KDRAY_FEATURE_NORMAL_MAPS KDRAY_FEATURE(61)
#define KDRAY_FEATURE_LIGHT_MAPS KDRAY_FEATURE(62)
#define KDRAY_FEATURE_COST KDRAY_FEATURE(63)  // counts nodes and tests per ray, for the cost channel

#ifdef __OPENCL_C_VERSION__
#ifndef KDRAY_FEATURES
// Instances are left out: streams have other fields with them. So is the filter, whose hits mean something
// else.
#define KDRAY_FEATURES (~(KDRAY_KEEP_ALL | KDRAY_FEATURE_INSTANCES | KDRAY_FEATURE_FILTER))
#endif
#define KDRAY_HAS_KIND(NAME) ((KDRAY_FEATURES & KDRAY_FEATURE_KIND(NAME)) != 0)
#define KDRAY_HAS_ZERO_AREA ((KDRAY_FEATURES & KDRAY_FEATURE_ZERO_AREA) != 0)
#define KDRAY_HAS_SMOOTH (KDRAY_HAS_ZERO_AREA || (KDRAY_FEATURES & KDRAY_FEATURE_SMOOTH) != 0)
#define KDRAY_HAS_NUMBERS ((KDRAY_FEATURES & KDRAY_FEATURE_NUMBERS) != 0)
#define KDRAY_HAS_MASKS ((KDRAY_FEATURES & KDRAY_FEATURE_MASKS) != 0)
#define KDRAY_HAS_FILTER ((KDRAY_FEATURES & KDRAY_FEATURE_FILTER) != 0)
#define KDRAY_HAS_MATERIAL_MAPS ((KDRAY_FEATURES & KDRAY_FEATURE_MATERIAL_MAPS) != 0)
#define KDRAY_HAS_CORNER_COLORS ((KDRAY_FEATURES & KDRAY_FEATURE_CORNER_COLORS) != 0)
#define KDRAY_HAS_TEXTURES ((KDRAY_FEATURES & KDRAY_FEATURE_TEXTURES) != 0)
#define KDRAY_HAS_FOOTPRINTS ((KDRAY_FEATURES & KDRAY_FEATURE_FOOTPRINTS) != 0)
#define KDRAY_HAS_METAL_MAPS (KDRAY_HAS_MATERIAL_MAPS && (KDRAY_FEATURES & KDRAY_FEATURE_METAL_MAPS) != 0)
#define KDRAY_HAS_NORMAL_MAPS (KDRAY_HAS_MATERIAL_MAPS && (KDRAY_FEATURES & KDRAY_FEATURE_NORMAL_MAPS) != 0)
#define KDRAY_HAS_LIGHT_MAPS (KDRAY_HAS_MATERIAL_MAPS && (KDRAY_FEATURES & KDRAY_FEATURE_LIGHT_MAPS) != 0)
// In queries, which ask for the shape, triangles have no holes.
#ifdef KDRAY_WHOLE_TRIANGLES
#define KDRAY_HAS_CUTOUTS 0
#else
#define KDRAY_HAS_CUTOUTS ((KDRAY_FEATURES & KDRAY_FEATURE_CUTOUTS) != 0)
#endif
// Whether material maps are read: when shading, or for holes.
#define KDRAY_HAS_TEXTURING (KDRAY_HAS_MATERIAL_MAPS || KDRAY_HAS_CUTOUTS)
#define KDRAY_HAS_REFLECT ((KDRAY_FEATURES & KDRAY_FEATURE_REFLECT) != 0)
#define KDRAY_HAS_TRANSMIT ((KDRAY_FEATURES & KDRAY_FEATURE_TRANSMIT) != 0)
#define KDRAY_HAS_SPECULAR ((KDRAY_FEATURES & KDRAY_FEATURE_SPECULAR) != 0)
#define KDRAY_HAS_DIFFUSE ((KDRAY_FEATURES & KDRAY_FEATURE_DIFFUSE) != 0)
#define KDRAY_HAS_LIGHTS ((KDRAY_FEATURES & KDRAY_FEATURE_LIGHTS) != 0)
#define KDRAY_HAS_ATTENUATION ((KDRAY_FEATURES & KDRAY_FEATURE_ATTENUATION) != 0)
#define KDRAY_HAS_DIRECTIONAL ((KDRAY_FEATURES & KDRAY_FEATURE_DIRECTIONAL) != 0)
#define KDRAY_HAS_SPOT ((KDRAY_FEATURES & KDRAY_FEATURE_SPOT) != 0)
#define KDRAY_HAS_SKY ((KDRAY_FEATURES & KDRAY_FEATURE_SKY) != 0)
#define KDRAY_HAS_AREA_LIGHTS ((KDRAY_FEATURES & KDRAY_FEATURE_AREA_LIGHTS) != 0)
#define KDRAY_HAS_LENS ((KDRAY_FEATURES & KDRAY_FEATURE_LENS) != 0)
#define KDRAY_HAS_FACES ((KDRAY_FEATURES & KDRAY_FEATURE_FACES) != 0)
#define KDRAY_HAS_FLOOR ((KDRAY_FEATURES & KDRAY_FEATURE_FLOOR) != 0)
#define KDRAY_HAS_INSTANCES ((KDRAY_FEATURES & KDRAY_FEATURE_INSTANCES) != 0)
#define KDRAY_HAS_BACKGROUND ((KDRAY_FEATURES & KDRAY_FEATURE_BACKGROUND) != 0)
#define KDRAY_HAS_SUPERSAMPLE ((KDRAY_FEATURES & KDRAY_FEATURE_SUPERSAMPLE) != 0)
#define KDRAY_HAS_ADAPTIVE ((KDRAY_FEATURES & KDRAY_FEATURE_ADAPTIVE) != 0)
#define KDRAY_HAS_COST ((KDRAY_FEATURES & KDRAY_FEATURE_COST) != 0)
#else
namespace kdray::layout {
using Features = std::uint64_t;
}
#endif
#endif
