// What    A scene as read from a file: primitives in file order and double precision, materials, lights,
//         camera.
// Shape   Triangles index a shared pool of vertices and normals; every primitive carries its number, the
//         0-based place in file order over all kinds (a polygon's triangles count one each, in order).
// Units   World units of the file, linear RGB, angles in radians.
// Errors  Loaders refuse NaN and infinity with file and line; what is in a Scene is finite, but a triangle
//         may be degenerate (geometry.h drops and counts those).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/box.h"
#include "base/memory.h"
#include "base/vec.h"
#include "kdray/options.h"
#include "scene/import/files.h"
#include "scene/model/instances.h"
#include "scene/model/names.h"
#include "scene/primitives/shapes.h"
#include "scene/textures/sky.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

inline constexpr std::uint32_t kNone = 0xffffffffu;

// The Whitted terms (docs/scenes.md), each with its colour multiplied in already:
//   C = emission + ambient*Camb + sum_lights Clight*att*(diffuse*(N.L) + specular*(R.V)^shine)
//     + reflect*C(reflected) + transmit*C(refracted)
struct Material {
  vec3 emission{0};
  vec3 ambient{0};
  vec3 diffuse{0};
  vec3 specular{0};
  vec3 reflect{0};
  vec3 transmit{0};
  float shine = 1;             // exponent of (R.V), >= 0
  float index = 1;             // index of refraction of the inside against the outside, > 0
  std::uint32_t maps = kNone;  // into Scene::texturing.material_maps, whose terms come to these
  bool operator==(const Material&) const = default;
};

// The last three have an area: a hit is lit from one place of it, which differs from sample to sample
// (kernels/shade/area_light.clh).
enum class LightKind { point, directional, spot, rectangle, sphere, disc };

constexpr bool has_area(LightKind kind) {
  return kind >= LightKind::rectangle;
}

struct Light {
  LightKind kind = LightKind::point;
  dvec3 position{0};           // all but directional; the middle of those with an area
  dvec3 direction{0, 0, -1};   // directional, spot: the way the light travels, unit length
  vec3 color{1};               // linear RGB intensity
  dvec3 attenuation{1, 0, 0};  // att(d) = 1 / (a.x + a.y*d + a.z*d^2); sum > 0, all >= 0
  double range = std::numeric_limits<double>::infinity();  // no light beyond this distance
  float cos_inner = 1, cos_outer = -1;                     // spot: full inside inner, none outside outer
  dvec3 across{0}, down{0};  // rectangle: its edges; disc: two of its radii, at right angles
  double radius = 0;         // sphere
};

// Makes a light a disc of that normal, which has unit length: sets its kind and two radii at right angles to
// the normal and to each other.
void set_disc(Light& light, const dvec3& normal, double radius);

// A camera with a pinhole or a thin lens, or an orthographic one. `vertical_fov` spans the full height of the
// picture, from its lower to its upper edge; the horizontal angle follows from the aspect ratio of the
// picture (square pixels).
struct Camera {
  dvec3 from{0, 0, 5}, at{0}, up{0, 1, 0};
  double vertical_fov = 0.7853981633974483;
  double hither = 0;  // distance along the view direction; what is nearer is not seen
  double ortho_width =
      0;                // > 0: orthographic, parallel rays from the plane through `from`; the picture's width
  double aperture = 0;  // > 0: the diameter of a thin lens; what is not in its focus is blurred
  double focus = 0;     // distance along the view direction of what is in focus; 0: that of `at`
  double aspect = 0;    // width by height of the picture that it is made for; 0: any
};

// A disc that rays see which meet nothing else (kernels/shade/floor.clh), as a surface of these terms.
struct Floor {
  dvec3 middle{0}, up{0, 1, 0};
  double inner = 0, radius = 0;  // it fades into the background from the one to the other; 0: there is none
  vec3 unshadowed{0}, diffuse{0};
  float reflect = 0;
};

// How a scene is shown in a studio (studio.h), by what its shape tells (accel/prepare/studio.cpp).
struct Studio {
  dvec3 up{0, 1, 0};
  bool perhaps_on_side = false;  // z may be up, but the shape doesn't tell for certain
  bool own_background = false;   // the scene has one
  bool stands = false;           // on a floor, as all of it is shown
  struct Room {
    dvec3 from, at;
  };
  std::optional<Room> room = {};      // of one that is closed all around: where a viewer in it stands
  std::optional<dvec3> open_to = {};  // of one that is open on one side: the way out
};

// What frame_scene() made up where the file has nothing, so that another view can be made up in the same way
// (frame.h).
struct Framing {
  bool camera = false, lights = false;
  DBox box;                           // of what is worth showing, which a reader may know; empty: nothing
  std::optional<Studio> studio = {};  // that the scene is seen in
  Floor floor = {};                   // that the studio has for the view
  double illuminance = 0;             // of a glTF file's lights in the middle, before its exposure
};

struct Triangle {
  std::array<std::uint32_t, 3> vertex;                       // into Scene::vertices
  std::array<std::uint32_t, 3> normal{kNone, kNone, kNone};  // into Scene::normals; all or none
  std::uint32_t material = 0;
  std::uint32_t number = 0;
};

#define KDRAY_SHAPE(NAME, name, names, Struct) using primitives::Struct;
KDRAY_SHAPES(KDRAY_SHAPE)
#undef KDRAY_SHAPE

// What a scene file may ask for; the command line wins over it.
struct RenderSettings {
  std::optional<int> width, height, depth, samples;
  std::optional<double> min_weight;
};

struct Scene {
  std::string name;  // the file it came from
  RawVector<dvec3> vertices;
  RawVector<vec3> normals;  // unit length
  PageVector<Triangle> triangles;
#define KDRAY_SHAPE_ARRAY(NAME, name, names, Struct) std::vector<Struct> names;
  KDRAY_SHAPES(KDRAY_SHAPE_ARRAY)
#undef KDRAY_SHAPE_ARRAY
  std::vector<std::shared_ptr<const Scene>> meshes;  // of primitives alone
  PageVector<Instance> instances;                    // of these, in file order
  std::vector<Material> materials;                   // at least one when there is a primitive
  Texturing texturing;
  std::vector<Light> lights;
  bool unlit = false;  // the file says that there are no lights; else frame_scene() adds some where none are
  std::optional<Camera> camera;  // loaders leave it empty when the file has none; frame_scene() fills it
  std::vector<Camera> cameras;   // all that the file has; `camera` is the first of them, or made up
  Framing framing;
  vec3 background{0};
  Sky sky;          // in place of the background's colour
  vec3 ambient{1};  // Camb
  RenderSettings settings;
  std::vector<std::string> warnings;   // one line each: what the loader left out or changed
  std::vector<FileRead> files;         // what it was loaded from, by load() only
  LoadOptions load_options;            // that it was loaded with
  std::shared_ptr<const Names> names;  // that the file gives; or null

  // Counts the scene's own primitives, without its meshes'.
  std::uint32_t primitive_count() const {
    return static_cast<std::uint32_t>(primitives::count_primitives(*this));
  }
  DBox bounds() const;  // with its instances'
  // Returns the material of the primitive of that number, which is of the instance's mesh where one is named;
  // kNone: there is no such primitive.
  std::uint32_t material_of(std::uint32_t number, std::uint32_t instance = kNone) const;
};

}  // namespace kdray::scene
