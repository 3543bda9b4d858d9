// What a scene is made of.
#include <nanobind/stl/array.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "interrupt.h"
#include "io/image/color.h"
#include "parts.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;
using namespace nb::literals;

BuildQuality quality_of(const std::string& name) {
  if (name == "fast") return BuildQuality::fast;
  if (name == "balanced") return BuildQuality::balanced;
  if (name == "best") return BuildQuality::best;
  throw Error(ErrorCode::usage, "quality is \"fast\", \"balanced\" or \"best\", not \"" + name + "\"");
}

VertexPrecision geometry_of(const std::string& name) {
  if (name == "float") return VertexPrecision::float32;
  if (name == "double") return VertexPrecision::float64;
  if (name == "auto") return VertexPrecision::automatic;
  throw Error(ErrorCode::usage, "geometry is \"float\", \"double\" or \"auto\", not \"" + name + "\"");
}

Instances instances_of(const std::string& name) {
  if (name == "auto") return Instances::automatic;
  if (name == "kept") return Instances::kept;
  if (name == "flat") return Instances::flat;
  throw Error(ErrorCode::usage, "instances is \"auto\", \"kept\" or \"flat\", not \"" + name + "\"");
}

void add_geometries(SceneClass& scene) {
  scene.def(
      "add_mesh",
      [](Scene& s, const In& vertices, const In& triangles, const In& normals, const In& texcoords,
         const std::string& name, std::uint32_t mask, std::uint32_t material, bool prototype) {
        return s.add_mesh(
            {points_of(vertices), triples_of(triangles), points_of(normals), pairs_of(texcoords)},
            {name, mask, material, prototype});
      },
      Released(), "vertices"_a, "triangles"_a, "normals"_a.none(), "texcoords"_a.none(), "name"_a, "mask"_a,
      "material"_a, "prototype"_a);
  // `arrays`: of the kind's fields, in their order; None: left out.
  scene.def(
      "add_shapes",
      [](Scene& s, const std::string& kind, const std::vector<In>& arrays, const std::string& name,
         std::uint32_t mask, std::uint32_t material, bool prototype) {
        Shapes shapes{kind, {}};
        const std::vector<ShapeKind::Field>& fields = shape_kind(kind).fields;
        for (std::size_t i = 0; i < arrays.size(); ++i) {
          if (!arrays[i]) continue;
          const ShapeKind::Field& field = fields.at(i);
          if (field.is_vector)
            shapes.fields.push_back({field.name, points_of(arrays[i])});
          else
            shapes.fields.push_back({field.name, values_of(arrays[i])});
        }
        return s.add_shapes(shapes, {name, mask, material, prototype});
      },
      Released(), "kind"_a, "arrays"_a, "name"_a, "mask"_a, "material"_a, "prototype"_a);
  scene.def(
      "add_instances",
      [](Scene& s, GeometryId prototype, const In& transforms, const In& materials, const std::string& name,
         std::uint32_t mask) {
        return s.add_instances(prototype, transforms_of(transforms), {name, mask, words_of(materials)});
      },
      Released(), "prototype"_a, "transforms"_a, "materials"_a.none(), "name"_a, "mask"_a);
  scene.def(
      "update_transforms",
      [](Scene& s, GeometryId id, const In& transforms) {
        s.update_transforms(id, transforms_of(transforms));
      },
      Released(), "id"_a, "transforms"_a);
  scene.def(
      "update_vertices",
      [](Scene& s, GeometryId id, const In& vertices, const In& normals) {
        s.update_vertices(id, points_of(vertices), points_of(normals));
      },
      Released(), "id"_a, "vertices"_a, "normals"_a.none());
  scene.def("remove", &Scene::remove);
  scene.def("enable", &Scene::enable);
  scene.def("set_mask", &Scene::set_mask);
  scene.def("geometries", &Scene::geometries);
  scene.def("info", [](const Scene& s, GeometryId id) {
    const GeometryInfo info = s.info(id);
    return nb::make_tuple(info.name, info.mask, info.primitives, info.enabled, info.prototype,
                          info.instances);
  });
  scene.def("mesh", [](const Scene& s, GeometryId id) {
    MeshArrays mesh = s.mesh(id);
    return nb::make_tuple(owned_rows(std::move(mesh.vertices)), owned_rows(std::move(mesh.triangles)));
  });
  const auto rows_of = [](const std::vector<Part>& parts) {
    std::vector<std::tuple<std::string, std::uint32_t, std::uint32_t>> rows;
    for (const Part& p : parts) rows.emplace_back(p.name, p.first, p.count);
    return rows;
  };
  scene.def("parts", [rows_of](const Scene& s, GeometryId id) { return rows_of(s.parts(id)); });
  scene.def("instance_parts",
            [rows_of](const Scene& s, GeometryId id) { return rows_of(s.instance_parts(id)); });
  scene.def("materials", [](const Scene& s) {
    std::vector<std::pair<std::string, std::uint32_t>> rows;
    for (const MaterialInfo& m : s.materials()) rows.emplace_back(m.name, m.primitives);
    return rows;
  });
  scene.def(
      "materials_of",
      [](const Scene& s, const In& geometry, const In& primitive, const In& instance, const Out& out) {
        const Words geometries = words_of(geometry), primitives = words_of(primitive),
                    instances = words_of(instance);
        words_out(out).fill(0, geometries.size(), [&](std::size_t i) {
          return std::array{s.material_of(geometries[i][0], primitives[i][0],
                                          instances.empty() ? kNoInstance : instances[i][0])};
        });
      },
      "geometry"_a, "primitive"_a, "instance"_a.none(), "out"_a);
  scene.def("primitives", &Scene::primitives);
  scene.def("bounds", [](const Scene& s) {
    const std::optional<Extent> extent = s.extent();
    return extent ? std::optional(std::pair(extent->least, extent->greatest)) : std::nullopt;
  });
  scene.def("warnings", &Scene::warnings);
}

Light::Kind light_kind(const std::string& name) {
  using Kind = Light::Kind;
  constexpr std::pair<const char*, Kind> kKinds[] = {
      {"point", Kind::point},         {"directional", Kind::directional}, {"spot", Kind::spot},
      {"rectangle", Kind::rectangle}, {"sphere", Kind::sphere},           {"disc", Kind::disc}};
  for (const auto& [n, kind] : kKinds)
    if (name == n) return kind;
  throw Error(
      ErrorCode::usage,
      "a light is \"point\", \"directional\", \"spot\", \"rectangle\", \"sphere\" or \"disc\", not \"" +
          name + "\"");
}

void add_looks(SceneClass& scene) {
  scene.def("add_light",
            [](Scene& s, const std::string& kind, const Vec3& position, const Vec3& direction,
               const Color& color, const Vec3& attenuation, double range, double inner, double outer,
               const Vec3& across, const Vec3& down, const Vec3& normal, double radius) {
              s.add_light({light_kind(kind), position, direction, color, attenuation, range, inner, outer,
                           across, down, normal, radius});
            });
  scene.def("set_camera", [](Scene& s, const Vec3& from, const Vec3& at, const Vec3& up, double fov,
                             double ortho_width, double hither, double aperture, double focus) {
    s.set_camera({from, at, up, fov, ortho_width, hither, aperture, focus});
  });
  scene.def("set_background", nb::overload_cast<const Color&>(&Scene::set_background));
  scene.def("set_gradient", [](Scene& s, const std::vector<double>& heights, const std::vector<Color>& colors,
                               const Vec3& up) {
    Gradient gradient{.stops = {}, .up = up};
    for (std::size_t i = 0; i < heights.size(); ++i) gradient.stops.push_back({heights[i], colors.at(i)});
    s.set_background(gradient);
  });
  scene.def("set_environment",
            [](Scene& s, const std::string& file, const Vec3& up, double turn, double strength) {
              s.set_background(Environment{file, up, turn, strength});
            });
  scene.def("set_ambient", &Scene::set_ambient);
}

}  // namespace

SceneClass add_scene(nb::module_& module) {
  module.def("css_color", [](const std::string& text) {
    const auto color = image::css_color(text);
    if (!color)
      throw Error(ErrorCode::usage,
                  "the colour '" + text + "': expected a name of CSS, #rgb, #rrggbb, or three linear values");
    return Color{color->x, color->y, color->z};
  });
  module.def("shape_fields", [](const std::string& kind) {
    std::vector<std::tuple<std::string, bool, bool>> fields;
    for (const ShapeKind::Field& f : shape_kind(kind).fields)
      fields.emplace_back(f.name, f.is_vector, f.may_be_left_out);
    return fields;
  });
  SceneClass scene(module, "Scene");
  scene.def(nb::init<>());
  scene.def_static(
      "load",
      [](const std::string& file, std::optional<double> smooth_degrees, std::optional<double> time,
         const std::string& animation, const std::string& asset_root, const std::string& instances) {
        return Scene::load(file, {.smooth_degrees = smooth_degrees,
                                  .time = time,
                                  .animation = animation,
                                  .instances = instances_of(instances),
                                  .asset_root = asset_root});
      },
      Released(), "file"_a, "smooth_degrees"_a.none(), "time"_a.none() = nb::none(), "animation"_a = "",
      "asset_root"_a = "", "instances"_a = "auto");
  add_geometries(scene);
  add_looks(scene);
  add_textures(scene);
  scene.def(
      "commit",
      [](Scene& s, const std::string& quality, const std::string& device, int compute_units, bool binary_form,
         const std::string& geometry) {
        CommitOptions options;
        options.tree.quality = quality_of(quality);
        options.tree.binary_form = binary_form;
        options.tree.geometry = geometry_of(geometry);
        options.device.device = device;
        options.device.compute_units = compute_units;
        options.device.programs = default_program_folder();
        return s.commit(options).geometry == VertexPrecision::float64;
      },
      Released(), "quality"_a, "device"_a, "compute_units"_a, "binary_form"_a, "geometry"_a);
  return scene;
}

}  // namespace kdray::python
