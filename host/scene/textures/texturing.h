// What    What surfaces show beyond one material for a primitive: pictures, laid onto triangles by the
//         coordinates at their corners, and colours at corners. A material that takes part has material maps,
//         which say what the base colour multiplies.
// Shape   colors, texcoords and tangents have an entry for each of the scene's first triangles, or none at
//         all: a triangle behind their end is white, with coordinates 0 and no tangents. Pictures are shared,
//         and never changed.
// Units   Colours at corners are linear, in 65535ths; maps' terms and factors are linear as well. A
//         picture's bytes are as its file has them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory.h"
#include "base/vec.h"
#include "layout/textures.layout.h"

namespace kdray::scene {

struct Material;

struct Picture {
  std::string name;  // in messages
  std::uint32_t width = 0, height = 0;
  Array<std::uint8_t> texels;  // red, green, blue, alpha, row by row from the top
};

// Returns a picture whose texels the caller sets; they may lie in a file (base/paged.h).
Picture blank_picture(const std::string& name, std::uint32_t width, std::uint32_t height);

enum class Wrap : std::uint32_t {
  repeat = KDRAY_WRAP_REPEAT,
  mirror = KDRAY_WRAP_MIRROR,
  clamp = KDRAY_WRAP_CLAMP
};

// What is sampled where a picture is shown smaller than it is, as glTF and OpenGL name it: one texel or four,
// of the picture itself, of the mipmap that is nearest in size, or of two.
enum class Minify : std::uint32_t {
  as_magnified,  // as where it is shown larger
  nearest,
  linear,
  nearest_mipmap_nearest,
  linear_mipmap_nearest,
  nearest_mipmap_linear,
  linear_mipmap_linear
};
inline bool has_mipmaps(Minify m) {
  return m >= Minify::nearest_mipmap_nearest;
}

// How a picture is laid onto triangles. From the left of the picture it is looked at across[0]*u +
// across[1]*v + across[2] of its width, from the top at the same of its height with `down`.
struct Texture {
  std::uint32_t picture = 0;
  std::array<float, 3> across{1, 0, 0}, down{0, 1, 0};
  Wrap wrap_across = Wrap::repeat, wrap_down = Wrap::repeat;
  bool nearest = false;  // where it is shown as large as it is, or larger
  Minify minify = Minify::as_magnified;
  bool curved = true;     // its colours are codes of sRGB
  std::uint32_t set = 0;  // of the coordinates at the corners
  bool operator==(const Texture&) const = default;
};

enum class Alpha : std::uint32_t {
  opaque,
  mask,  // nothing is there where alpha is below the cutoff
  blend  // the share 1 - alpha of the light goes through
};

// What a picture of metallic and rough places multiplies: green is how rough, blue how metallic.
struct Metal {
  vec3 base{1};  // the base colour's factor
  float metallic = 1, roughness = 1;
  float transmission = 0, mirrored = 0;  // what goes through, and the share of it that is reflected
  bool operator==(const Metal&) const = default;
};

// These terms, times the base colour, come to the material's own (scene.h). The base colour is what the
// texture shows times the colour between the triangle's corners; its alpha is `alpha` times theirs.
struct MaterialMaps {
  vec3 emission{0}, ambient{0}, diffuse{0}, specular{0}, reflect{0}, transmit{0};
  float alpha = 1, cutoff = 0.5f;
  std::uint32_t base = 0xffffffffu;  // into the textures; none: white
  std::uint32_t colored = 0;         // 1: by the colours at corners
  std::uint32_t tangents = 0;        // 1: those at corners say how the picture of normals lies
  Alpha mode = Alpha::opaque;
  // Further pictures, into the textures, or none.
  std::uint32_t normal_map = 0xffffffffu;
  float normal_scale = 1;                    // of what bends the normal
  std::uint32_t emission_map = 0xffffffffu;  // times `emissive`, comes to the emission
  vec3 emissive{0};
  std::uint32_t occlusion_map = 0xffffffffu;  // its red, what ambient light is left
  float occlusion = 1;                        // 0: it doesn't count
  std::uint32_t highlight_map = 0xffffffffu;  // multiplies specular and reflect in place of the base colour
  std::uint32_t metal_map = 0xffffffffu;      // the terms follow from it and `metal`, not from those above
  Metal metal = {};
  bool operator==(const MaterialMaps&) const = default;
};

// Returns the largest terms that maps can have anywhere, base colours being 1 at most.
MaterialMaps largest_terms(const MaterialMaps& maps);
// Returns whether a texture on this picture looks different where it is shown smaller.
bool needs_footprints(const Texture& texture, const Picture& picture);

inline constexpr layout::CornerColors kWhiteCorners = {
    {{0xffffffffu, 0xffffffffu}, {0xffffffffu, 0xffffffffu}, {0xffffffffu, 0xffffffffu}}};

struct Texturing {
  PageVector<layout::CornerColors> colors = {};
  std::array<PageVector<layout::TexCoords>, 2> texcoords = {};
  PageVector<layout::TexCoords> tangents = {};  // as tangents.h packs them
  std::vector<MaterialMaps> material_maps = {};
  std::vector<Texture> textures = {};
  std::vector<std::shared_ptr<const Picture>> pictures = {};

  std::uint32_t add(const std::shared_ptr<const Picture>& picture);
  std::uint32_t add(const Texture& texture);
  std::uint32_t add(const MaterialMaps& maps);

  // Appends the texturing of a scene that has `n_triangles`; this one's scene had `before` triangles until
  // then. Returns the numbers that the part's maps have here.
  std::vector<std::uint32_t> append(const Texturing& part, std::size_t before, std::size_t n_triangles);
};

// Return a linear value from 0 to 1, or one as sRGB's curve codes it, in 65535ths.
std::uint32_t linear_unit(double value);
std::uint32_t linear_unit_of_srgb(double code);

// Sets a corner's colour from red, green, blue and alpha in 65535ths.
void set_corner(layout::CornerColors& colors, std::size_t corner, const std::array<std::uint32_t, 4>& rgba);

// Returns what a material becomes that a program, or kdray's JSON, gives pictures: its terms, parted into
// what they multiply, which goes to its maps, and what they leave alone. With a picture of metal all terms
// but the emission follow from the base colour, as glTF's do. `maps` has its textures, alpha's mode, what the
// emission's picture is multiplied by, and metal's factors.
Material with_pictures(const Material& terms, const MaterialMaps& maps, Texturing& texturing);

// Returns the rule that a factor of a picture breaks; nullptr where none does.
const char* fault_of_factors(const MaterialMaps& maps);

}  // namespace kdray::scene
