// What    The keys of every kind of object in kdray's JSON scenes: what the reader accepts, and what
//         docs/scene.schema.json is tested against.
// Shape   `name` is the object's name under "$defs" in the schema ("scene" is the schema itself).
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <tuple>

#include "scene/primitives/shapes.h"

namespace kdray::scene {

struct JsonKeys {
  std::string_view name;
  std::span<const std::string_view> keys;
};

namespace json_keys {

namespace list {
inline constexpr std::string_view scene[] = {"$schema", "kdray",     "camera", "background", "ambient",
                                             "render",  "materials", "lights", "objects"};
inline constexpr std::string_view camera[] = {"from",  "at",     "up",       "fov",
                                              "ortho", "hither", "aperture", "focus"};
inline constexpr std::string_view render[] = {"size", "depth", "samples", "min_weight"};
inline constexpr std::string_view material[] = {"color",
                                                "ka",
                                                "kd",
                                                "ks",
                                                "shine",
                                                "reflect",
                                                "transmit",
                                                "index",
                                                "emission",
                                                "picture",
                                                "normal_picture",
                                                "emission_picture",
                                                "alpha",
                                                "metal_picture",
                                                "metallic",
                                                "roughness",
                                                "occlusion_picture",
                                                "occlusion"};
inline constexpr std::string_view point_light[] = {"type", "position", "color", "attenuation", "range"};
inline constexpr std::string_view directional_light[] = {"type", "direction", "color"};
inline constexpr std::string_view spot_light[] = {"type",  "position", "direction",   "inner",
                                                  "outer", "color",    "attenuation", "range"};
inline constexpr std::string_view rectangle_light[] = {"type",  "position",    "across", "down",
                                                       "color", "attenuation", "range"};
inline constexpr std::string_view sphere_light[] = {"type",  "position",    "radius",
                                                    "color", "attenuation", "range"};
inline constexpr std::string_view disc_light[] = {"type",  "position",    "normal", "radius",
                                                  "color", "attenuation", "range"};
inline constexpr std::string_view stop[] = {"height", "color"};
inline constexpr std::string_view gradient[] = {"type", "stops", "up"};
inline constexpr std::string_view sky_picture[] = {"type", "file", "up", "turn", "strength"};
inline constexpr std::string_view mesh[] = {"type",  "file",   "material", "translate", "rotate",
                                            "scale", "matrix", "smooth",   "instances"};
inline constexpr std::string_view instance[] = {"translate", "rotate", "scale", "matrix", "material"};
inline constexpr std::string_view triangles[] = {"type",      "vertices", "faces", "normals", "material",
                                                 "translate", "rotate",   "scale", "matrix",  "uv"};
inline constexpr std::string_view box[] = {"type",      "min",    "max",   "material",
                                           "translate", "rotate", "scale", "matrix"};
inline constexpr std::string_view cylinder[] = {"type", "base", "apex", "radius", "apex_radius", "material"};
inline constexpr std::string_view plane[] = {"type", "point", "normal", "extent", "material"};
// A shape's keys: those of its fields, between those that all shapes have.
template <class Shape>
inline constexpr auto shape = std::apply(
    [](const auto&... fields) {
      return std::array<std::string_view, sizeof...(fields) + 2>{"type", fields.key..., "material"};
    },
    fields_of(static_cast<const Shape*>(nullptr)));
inline constexpr std::string_view turn[] = {"axis", "angle"};
}  // namespace list

inline constexpr JsonKeys kScene{"scene", list::scene};
inline constexpr JsonKeys kCamera{"camera", list::camera};
inline constexpr JsonKeys kRender{"render", list::render};
inline constexpr JsonKeys kMaterial{"material", list::material};
inline constexpr JsonKeys kPointLight{"point_light", list::point_light};
inline constexpr JsonKeys kDirectionalLight{"directional_light", list::directional_light};
inline constexpr JsonKeys kSpotLight{"spot_light", list::spot_light};
inline constexpr JsonKeys kRectangleLight{"rectangle_light", list::rectangle_light};
inline constexpr JsonKeys kSphereLight{"sphere_light", list::sphere_light};
inline constexpr JsonKeys kDiscLight{"disc_light", list::disc_light};
inline constexpr JsonKeys kStop{"stop", list::stop};
inline constexpr JsonKeys kGradient{"gradient", list::gradient};
inline constexpr JsonKeys kSkyPicture{"sky_picture", list::sky_picture};
inline constexpr JsonKeys kMesh{"mesh", list::mesh};
inline constexpr JsonKeys kInstance{"instance", list::instance};
inline constexpr JsonKeys kTriangles{"triangles", list::triangles};
inline constexpr JsonKeys kBox{"box", list::box};
inline constexpr JsonKeys kCylinder{"cylinder", list::cylinder};
inline constexpr JsonKeys kPlane{"plane", list::plane};
inline constexpr JsonKeys kTurn{"turn", list::turn};

template <class Kind>
constexpr JsonKeys keys_of(Kind) {
  return {Kind::kName, list::shape<typename Kind::Source>};
}

#define KDRAY_SHAPE_KEYS(NAME, name, names, Struct) keys_of(primitives::Struct##Kind()),
inline constexpr std::array kAll = {kScene,
                                    kCamera,
                                    kRender,
                                    kMaterial,
                                    kPointLight,
                                    kDirectionalLight,
                                    kSpotLight,
                                    kMesh,
                                    kInstance,
                                    kTriangles,
                                    KDRAY_SHAPES(KDRAY_SHAPE_KEYS) kTurn,
                                    kRectangleLight,
                                    kSphereLight,
                                    kDiscLight,
                                    kStop,
                                    kGradient,
                                    kSkyPicture,
                                    kBox,
                                    kCylinder,
                                    kPlane};
#undef KDRAY_SHAPE_KEYS

}  // namespace json_keys

}  // namespace kdray::scene
