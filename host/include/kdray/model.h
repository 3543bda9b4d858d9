// What    What a scene is made of when a program makes it: geometries, how they look, what lights them, who
//         sees them.
// Shape   Plain values and views (arrays.h); a Scene copies what it is given.
// Units   The program's own units of length, in double; linear RGB; angles in degrees.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "kdray/arrays.h"

namespace kdray {

using Vec3 = std::array<double, 3>;
using Color = std::array<float, 3>;

// A geometry of a Scene: 0 is the first that was added, or all that was in the file. Never given twice.
using GeometryId = std::uint32_t;
inline constexpr GeometryId kNoGeometry = 0xffffffffu;
inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;
inline constexpr std::uint32_t kNoInstance = 0xffffffffu;
inline constexpr std::uint32_t kNoMaterial = 0xffffffffu;

using MaterialId = std::uint32_t;
using PictureId = std::uint32_t;
inline constexpr PictureId kNoPicture = 0xffffffffu;

// Triangles, three indices into `vertices` each. `normals`: one for each vertex, of any length but 0, or
// none. `texcoords`: where in its material's pictures each vertex lies, or none: (0, 0) is a picture's upper
// left corner, (1, 1) its lower right one, and beyond them it is repeated.
struct Mesh {
  Points vertices;
  Triples triangles;
  Points normals = {};
  Pairs texcoords = {};
};

// A picture in memory, row by row from the top: grey, grey with alpha, red green blue, or these with alpha;
// codes of sRGB, as files have them.
struct Pixels {
  const std::uint8_t* data = nullptr;
  std::uint32_t width = 0, height = 0;
  std::uint32_t channels = 3;  // 1 to 4
  std::size_t row_bytes = 0;   // from one row to the next; 0: none between them
};

// What a picture's alpha means: nothing; below a half nothing is there; or the share of light that isn't let
// through.
enum class AlphaMode { opaque, mask, blend };

struct Spheres {
  Points centers;
  Values radii;  // above 0; one for each, or one for all
};

// Truncated cones and cylinders without caps, seen from both sides, from one end of the axis to the other.
struct Cones {
  Points bases, apexes;
  // At least 0, not both 0; one for each, or one for all. Without apex_radii they are pointed.
  Values base_radii, apex_radii = {};
};

// Flat, seen from both sides.
struct Discs {
  Points centers, normals;  // of any length but 0
  Values radii;             // above 0; one for each, or one for all
};

// Rings: what lies `minor_radii` off a circle of `major_radii` about the centre, across the axis.
struct Tori {
  Points centers, axes;             // of any length but 0
  Values major_radii, minor_radii;  // one for each, or one for all: 0 < minor < major <= 4096 minor
};

// Shapes of any kind: by the kind's plural, and an array for each of its fields, in any order.
struct ShapeField {
  std::string name;
  std::variant<Points, Values> rows;  // Points: one for each shape; Values: one for each, or one for all
};
struct Shapes {
  std::string kind;
  std::vector<ShapeField> fields;
};

// The kinds that there are, with their fields; add_spheres() and its like are names for add_shapes().
struct ShapeKind {
  struct Field {
    std::string name;
    bool is_vector;        // Points, else Values
    bool may_be_left_out;  // 0 then
  };
  std::string name;  // "spheres"
  std::vector<Field> fields;
};
const std::vector<ShapeKind>& shape_kinds();
const ShapeKind& shape_kind(const std::string& name);  // ErrorCode::usage where there is none

struct GeometryOptions {
  std::string name = {};
  // A ray meets the geometry where its own mask and this one have a bit in common.
  std::uint32_t mask = 0xffffffffu;
  MaterialId material = 0;
  // It is seen by its instances alone (Scene::add_instances), which have masks of their own.
  bool prototype = false;
};

// Instances of one prototype are a geometry together. A transform takes the prototype to the scene: its rows
// are those of linear | move, p -> linear * p + move, as 12 values one after the other. It may mirror and
// stretch, one direction up to 48 times as much as another.
struct InstanceOptions {
  std::string name = {};
  std::uint32_t mask = 0xffffffffu;  // of all of them
  // Of each in place of the prototype's, or kOwnMaterial; one for all; or none.
  Words materials = {};
};
inline constexpr MaterialId kOwnMaterial = 0xffffffffu;

// The Whitted terms of docs/scenes.md, each with its colour multiplied in. The default is a matt light grey.
struct Material {
  Color emission{0, 0, 0}, ambient{0.08f, 0.08f, 0.08f}, diffuse{0.8f, 0.8f, 0.8f}, specular{0, 0, 0};
  Color reflect{0, 0, 0}, transmit{0, 0, 0};
  float shine = 1;  // exponent of the highlight, at least 0
  float index = 1;  // of refraction, above 0
  // Pictures on meshes with texture coordinates. The first is multiplied by the ambient and diffuse terms and
  // by what goes through, the last by the emission, or by white where that is black.
  PictureId picture = kNoPicture, normal_picture = kNoPicture, emission_picture = kNoPicture;
  AlphaMode alpha = AlphaMode::opaque;  // of `picture`
  // As glTF's: green is how rough, blue how metallic, each times its factor (0 to 1). With this picture all
  // terms but the emission follow from these and from the base colour, which is `diffuse` times `picture`.
  PictureId metal_picture = kNoPicture;
  float metallic = 1, roughness = 1;
  // Its red is the share of ambient light that gets there; with `occlusion` below 1 that much of it counts.
  PictureId occlusion_picture = kNoPicture;
  float occlusion = 1;
};

struct Light {
  // The last three have an area, and throw soft shadows: each sample of a pixel sees another place of it.
  enum class Kind { point, directional, spot, rectangle, sphere, disc };
  Kind kind = Kind::point;
  Vec3 position{0, 0, 0};    // all but directional; the middle of those with an area
  Vec3 direction{0, 0, -1};  // directional, spot: the way the light travels, of any length but 0
  Color color{1, 1, 1};
  Vec3 attenuation{1, 0, 0};  // 1 / (a[0] + a[1]*d + a[2]*d^2)
  double range = std::numeric_limits<double>::infinity();
  double inner_degrees = 0, outer_degrees = 45;  // spot: half angles, full light inside of the inner one
  Vec3 across{0, 0, 0}, down{0, 0, 0};           // rectangle: its edges
  Vec3 normal{0, -1, 0};                         // disc: of any length but 0
  double radius = 0;                             // sphere, disc
};

struct Camera {
  Vec3 from{0, 0, 5}, at{0, 0, 0}, up{0, 1, 0};
  double fov = 45;         // of the picture's full height
  double ortho_width = 0;  // above 0: orthographic; the picture's width
  double hither = 0;       // nothing is seen nearer than this
  double aperture = 0;     // above 0: the diameter of a thin lens; what is not in its focus is blurred
  double focus = 0;        // how far off what is in focus is, along the view; 0: as far as `at`
};

// What is seen where nothing is: colours by height, which is the sine of the angle above the horizon, from -1
// to 1. Heights ascend; below the first and above the last their colours go on.
struct GradientStop {
  double height = 0;
  Color color{0, 0, 0};
};
struct Gradient {
  std::vector<GradientStop> stops;
  Vec3 up{0, 1, 0};  // of any length but 0
};

// A picture all around (equirectangular), from an EXR, Radiance HDR, PNG or JPEG file. Its top lies at `up`,
// its middle at -z; turned about `up`, right-handed.
struct Environment {
  std::filesystem::path file;
  Vec3 up{0, 1, 0};
  double turn_degrees = 0;
  double strength = 1;  // what it shows is multiplied by this
};

}  // namespace kdray
