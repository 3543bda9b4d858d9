#include "scene/model/added_geometry.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/local_space.h"
#include "scene/model/check_scene.h"
#include "scene/model/first_fault.h"
#include "scene/model/normals.h"
#include "scene/model/scene.h"
#include "scene/textures/sky.h"

namespace kdray::scene {

namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::input, what);
}

dvec3 vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}
vec3 color(const Color& c) {
  return {c[0], c[1], c[2]};
}

RawVector<dvec3> finite_points(const Points& points, const char* name) {
  RawVector<dvec3> copy(points.size());
  const std::size_t bad = first_fault(points.size(), [&](std::size_t i) {
    copy[i] = vector(points[i]);
    return is_finite(copy[i]);
  });
  if (bad < points.size()) refuse(fmt::format("{}[{}]: not finite", name, bad));
  return copy;
}

RawVector<vec3> unit_normals(const Points& normals, std::size_t n_vertices) {
  if (normals.empty()) return {};
  if (normals.size() != n_vertices)
    refuse(fmt::format("normals: {} of them for {} vertices; give one for each, or none", normals.size(),
                       n_vertices));
  RawVector<vec3> copy(n_vertices);
  const std::size_t bad = first_fault(n_vertices, [&](std::size_t i) {
    const dvec3 n = vector(normals[i]);
    copy[i] = direction_of(n);
    return is_finite(n) && copy[i] != vec3(0);
  });
  if (bad < n_vertices) refuse(fmt::format("normals[{}]: not finite, or without a direction", bad));
  return copy;
}

// Copies vertices' coordinates to their triangles.
PageVector<layout::TexCoords> texcoords_of(const Mesh& mesh, const PageVector<Triangle>& triangles) {
  const std::size_t n = mesh.texcoords.size();
  if (n == 0) return {};
  if (n != mesh.vertices.size())
    refuse(fmt::format("texcoords: {} of them for {} vertices; give one for each, or none", n,
                       mesh.vertices.size()));
  RawVector<std::array<float, 2>> narrow(n);
  const std::size_t bad = first_fault(n, [&](std::size_t i) {
    const auto row = mesh.texcoords[i];
    narrow[i] = {static_cast<float>(row[0]), static_cast<float>(row[1])};
    return std::isfinite(narrow[i][0]) && std::isfinite(narrow[i][1]);
  });
  if (bad < n) refuse(fmt::format("texcoords[{}]: not finite, or beyond 3.4e38", bad));
  PageVector<layout::TexCoords> out(triangles.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 2; ++c) out[i].uv[k][c] = narrow[triangles[i].vertex[k]][c];
  });
  return out;
}

// Indices as the caller wrote them: those beyond 2^63 are negative ones.
std::string in_words(const Triples& triples, std::size_t i) {
  const auto row = triples[i];
  const auto written = [&](std::size_t k) { return static_cast<std::int64_t>(row[k]); };
  return fmt::format("({}, {}, {})", written(0), written(1), written(2));
}

void check_capacity(std::size_t n, const char* names) {
  if (n >= kMaxPrimitivesPerKind) refuse(fmt::format("{}: 2^28 of them or more; split the scene", names));
}

// Calls visit(field) for each field of a kind.
template <class Kind, class Visit>
void for_each_field(Kind, const Visit& visit) {
  using Shape = typename Kind::Source;
  std::apply([&](const auto&... field) { (visit(field), ...); },
             fields_of(static_cast<const Shape*>(nullptr)));
}
template <class Shape, class Value>
constexpr bool is_vector(const primitives::Field<Shape, Value>&) {
  return std::is_same_v<Value, dvec3>;
}
template <class Shape, class Value>
constexpr bool may_be_left_out(const primitives::Field<Shape, Value>& field) {
  return field.meaning == primitives::Meaning::at_least_zero_or_left_out;
}

const ShapeField* find_field(const Shapes& shapes, std::string_view name) {
  const auto found = std::ranges::find(shapes.fields, name, &ShapeField::name);
  return found == shapes.fields.end() ? nullptr : &*found;
}

void check_names(const Shapes& shapes) {
  const ShapeKind& kind = shape_kind(shapes.kind);
  for (const ShapeField& given : shapes.fields) {
    const auto known = std::ranges::find(kind.fields, given.name, &ShapeKind::Field::name);
    if (known == kind.fields.end())
      throw Error(ErrorCode::usage, fmt::format("{} have no {}", kind.name, given.name));
    if (known->is_vector != std::holds_alternative<Points>(given.rows))
      throw Error(ErrorCode::usage,
                  fmt::format("{}: {} are wanted", given.name, known->is_vector ? "vectors" : "numbers"));
    if (find_field(shapes, given.name) != &given)
      throw Error(ErrorCode::usage, fmt::format("{}: given twice", given.name));
  }
}

// Sets a field of all shapes.
template <class Shape>
void set_field(const primitives::Field<Shape, dvec3>& field, const ShapeField& given,
               std::vector<Shape>& shapes) {
  const Points& points = std::get<Points>(given.rows);
  if (points.size() != shapes.size())
    refuse(fmt::format("{}: {} of them for {} primitives", field.array, points.size(), shapes.size()));
  for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i].*field.member = vector(points[i]);
}
template <class Shape>
void set_field(const primitives::Field<Shape, double>& field, const ShapeField& given,
               std::vector<Shape>& shapes) {
  const Values& values = std::get<Values>(given.rows);
  if (values.size() != shapes.size() && values.size() != 1)
    refuse(fmt::format("{}: {} of them for {} primitives; give one for each, or one", field.array,
                       values.size(), shapes.size()));
  for (std::size_t i = 0; i < shapes.size(); ++i)
    shapes[i].*field.member = values[values.size() == 1 ? 0 : i][0];
}

// The kind's first field, a point, says how many there are. Each is checked by its kind's own rules.
template <class Kind>
std::vector<typename Kind::Source> shapes_of(Kind kind, const Shapes& given) {
  std::vector<typename Kind::Source> shapes;
  bool is_first = true;
  for_each_field(kind, [&](const auto& field) {
    const ShapeField* const rows = find_field(given, field.array);
    if (rows == nullptr && !may_be_left_out(field)) refuse(fmt::format("{}: none are given", field.array));
    if (rows != nullptr && std::exchange(is_first, false)) {
      const std::size_t n = std::get<Points>(rows->rows).size();
      check_capacity(n, Kind::kNames);
      shapes.resize(n);
    }
    if (rows != nullptr) set_field(field, *rows, shapes);
  });
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (const char* const fault = fault_of(shapes[i]))
      refuse(fmt::format("{}[{}]: {}", Kind::kNames, i, fault));
  return shapes;
}

}  // namespace

AddedGeometry make_added(const Mesh& mesh) {
  AddedGeometry geometry;
  const std::size_t n = mesh.triangles.size(), n_vertices = mesh.vertices.size();
  check_capacity(n, "triangles");
  if (n_vertices > 0xfffffffeu) refuse("vertices: over 2^32 - 2 of them; split the mesh");
  geometry.vertices = finite_points(mesh.vertices, "vertices");
  geometry.normals = unit_normals(mesh.normals, n_vertices);
  geometry.triangles.resize(n);
  const bool smooth = !geometry.normals.empty();
  const std::size_t bad = first_fault(n, [&](std::size_t i) {
    const auto corners = mesh.triangles[i];
    Triangle& t = geometry.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      // A negative index becomes one beyond all.
      if (static_cast<std::uint64_t>(corners[k]) >= n_vertices) return false;
      t.vertex[k] = static_cast<std::uint32_t>(corners[k]);
      if (smooth) t.normal[k] = t.vertex[k];
    }
    return true;
  });
  if (bad < n)
    refuse(fmt::format("triangles[{}]: an index of {} is out of range; there are {} vertices", bad,
                       in_words(mesh.triangles, bad), n_vertices));
  geometry.texcoords = texcoords_of(mesh, geometry.triangles);
  return geometry;
}

AddedGeometry make_added(const Shapes& shapes) {
  check_names(shapes);
  AddedGeometry geometry;
  primitives::for_each_shape([&](auto kind) {
    if (shapes.kind == kind.kNames) decltype(kind)::of(geometry) = shapes_of(kind, shapes);
  });
  return geometry;
}

void move_vertices(AddedGeometry& geometry, const Points& vertices, const Points& normals) {
  if (geometry.triangles.empty() && geometry.vertices.empty())
    throw Error(ErrorCode::usage, "only meshes have vertices that can be moved");
  if (vertices.size() != geometry.vertices.size())
    refuse(fmt::format("vertices: {} of them; the mesh has {}", vertices.size(), geometry.vertices.size()));
  if (!geometry.normals.empty() && normals.empty())
    refuse("normals: none; the mesh has them, so give one for each of the moved vertices");
  if (geometry.normals.empty() && !normals.empty()) refuse("normals: the mesh was added without");
  RawVector<dvec3> moved = finite_points(vertices, "vertices");
  RawVector<vec3> turned = unit_normals(normals, vertices.size());
  geometry.vertices = std::move(moved);
  geometry.normals = std::move(turned);
}

Material material_of(const kdray::Material& m) {
  const Material material{.emission = color(m.emission),
                          .ambient = color(m.ambient),
                          .diffuse = color(m.diffuse),
                          .specular = color(m.specular),
                          .reflect = color(m.reflect),
                          .transmit = color(m.transmit),
                          .shine = m.shine,
                          .index = m.index};
  if (const char* const fault = fault_of(material)) refuse(fmt::format("material: {}", fault));
  return material;
}

Light light_of(const kdray::Light& l) {
  constexpr double kRadians = std::numbers::pi / 180;
  using Kind = kdray::Light::Kind;
  static_assert(static_cast<int>(Kind::disc) == static_cast<int>(LightKind::disc));
  if (l.kind < Kind::point || l.kind > Kind::disc) refuse("light: there is no such kind");
  const auto good_angle = [](double degrees) { return degrees >= 0 && degrees <= 180; };
  if (!good_angle(l.inner_degrees) || !good_angle(l.outer_degrees))
    refuse("light: the spot's angles may be 0 to 180 degrees");
  Light light;
  light.kind = static_cast<LightKind>(l.kind);
  light.position = vector(l.position);
  light.color = color(l.color);
  light.attenuation = vector(l.attenuation);
  light.range = l.range;
  if (l.kind == Kind::directional || l.kind == Kind::spot) {
    const dvec3 direction = vector(l.direction);
    if (!is_finite(direction) || direction == dvec3(0)) refuse("light: the direction is not finite, or 0");
    light.direction = safe_normalize(direction);
  }
  if (l.kind == Kind::rectangle) light.across = vector(l.across), light.down = vector(l.down);
  if (l.kind == Kind::sphere) light.radius = l.radius;
  if (l.kind == Kind::disc) {
    const dvec3 normal = vector(l.normal);
    if (!is_finite(normal) || normal == dvec3(0)) refuse("light: the normal is not finite, or 0");
    set_disc(light, safe_normalize(normal), l.radius);
  }
  if (l.kind == Kind::spot) {
    light.cos_inner = static_cast<float>(std::cos(l.inner_degrees * kRadians));
    light.cos_outer = static_cast<float>(std::cos(l.outer_degrees * kRadians));
  }
  if (const char* const fault = fault_of(light)) refuse(fmt::format("light: {}", fault));
  return light;
}

Camera camera_of(const kdray::Camera& c) {
  const Camera camera{.from = vector(c.from),
                      .at = vector(c.at),
                      .up = vector(c.up),
                      .vertical_fov = c.fov * (std::numbers::pi / 180),
                      .hither = c.hither,
                      .ortho_width = c.ortho_width,
                      .aperture = c.aperture,
                      .focus = c.focus};
  if (const char* const fault = fault_of(camera)) refuse(fmt::format("camera: {}", fault));
  return camera;
}

Sky sky_of(const kdray::Gradient& g) {
  Sky sky{.kind = SkyKind::gradient, .up = safe_normalize(vector(g.up))};
  for (const GradientStop& stop : g.stops) sky.stops.push_back({stop.height, color(stop.color)});
  if (const char* const fault = fault_of(sky)) refuse(fmt::format("background: {}", fault));
  sky.brightest = brightest_of(sky);
  return sky;
}

Sky sky_of(const kdray::Environment& e, std::vector<std::string>& warnings) {
  Sky sky{.kind = SkyKind::picture,
          .up = safe_normalize(vector(e.up)),
          .turn = e.turn_degrees * (std::numbers::pi / 180),
          .strength = e.strength};
  if (const char* const fault = fault_of(sky)) refuse(fmt::format("background: {}", fault));
  sky.picture = read_sky_picture(e.file, warnings);
  sky.brightest = brightest_of(sky);
  return sky;
}

vec3 color_of(const Color& c, const char* name) {
  const vec3 v = color(c);
  if (!is_finite(dvec3(v)) || v.x < 0 || v.y < 0 || v.z < 0)
    refuse(fmt::format("{}: a colour is not finite, or below 0", name));
  return v;
}

}  // namespace kdray::scene

namespace kdray {

const std::vector<ShapeKind>& shape_kinds() {
  static const std::vector<ShapeKind> all = [] {
    std::vector<ShapeKind> kinds;
    primitives::for_each_shape([&](auto kind) {
      kinds.push_back({kind.kNames, {}});
      scene::for_each_field(kind, [&](const auto& field) {
        kinds.back().fields.push_back(
            {std::string(field.array), scene::is_vector(field), scene::may_be_left_out(field)});
      });
    });
    return kinds;
  }();
  return all;
}

const ShapeKind& shape_kind(const std::string& name) {
  std::string known;
  for (const ShapeKind& kind : shape_kinds()) {
    if (kind.name == name) return kind;
    known += (known.empty() ? "" : ", ") + kind.name;
  }
  throw Error(ErrorCode::usage, fmt::format("there are no shapes \"{}\", but {}", name, known));
}

}  // namespace kdray
