// What    A scene as a POV-Ray file (povray.h).
// Shape   Spheres, open cones, discs, one mesh of all triangles (smooth ones with their normals); materials
//         as pigment and finish: ambient, diffuse, phong = (R.V)^shine, reflection, filter for what passes,
//         ior. POV-Ray itself works the way kdray's model does, but its shadows of transparent objects are
//         filtered, not black. A kind that lacks a word does not compile.
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/povray/povray.h"

namespace kdray::bench {

namespace {

template <class Vec>
std::string vector(const Vec& v) {
  return fmt::format("<{:.9g},{:.9g},{:.9g}>", v.x, v.y, v.z);
}

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

// POV-Ray colours a surface once and scales that; kdray's terms have their colours multiplied in already.
void write_material(std::ostream& out, const scene::Material& m, std::size_t number) {
  const vec3 colored = largest(m.diffuse) > 0 ? m.diffuse : largest(m.transmit) > 0 ? m.transmit : m.ambient;
  const float scale = largest(colored) > 0 ? largest(colored) : 1;
  const float filter = std::min(1.0f, largest(m.transmit));
  // What is let through is taken from the surface's own light.
  const float opaque = std::max(1 - filter, 1e-3f);
  fmt::print(
      out,
      "#declare T{} = texture {{ pigment {{ rgbf <{:.9g},{:.9g},{:.9g},{:.9g}> }}\n"
      "  finish {{ ambient {:.9g} diffuse {:.9g} phong {:.9g} phong_size {:.9g} reflection rgb {} }} }}\n",
      number, colored.x / scale, colored.y / scale, colored.z / scale, filter, largest(m.ambient) / opaque,
      largest(m.diffuse) / opaque, largest(m.specular), m.shine, vector(m.reflect));
  fmt::print(out, "#declare I{} = interior {{ ior {:.9g} }}\n", number, m.index);
}

// POV-Ray's space is left-handed: `right` points the other way. `angle` is the horizontal one.
void write_camera(std::ostream& out, const scene::Camera& c, double aspect) {
  const double horizontal = 2 * std::atan(std::tan(c.vertical_fov / 2) * aspect) * 180 / std::numbers::pi;
  fmt::print(out, "camera {{ location {} right <{:.9g},0,0> up <0,1,0> sky {} angle {:.9g} look_at {} }}\n",
             vector(c.from), -aspect, vector(c.up), horizontal, vector(c.at));
}

void write_light(std::ostream& out, const scene::Light& light) {
  if (light.kind == scene::LightKind::directional) {
    fmt::print(out, "light_source {{ {} rgb {} parallel point_at <0,0,0> }}\n",
               vector(-1e6 * light.direction), vector(light.color));
  } else if (const vec3& a = light.attenuation; a.x > 0 && a.z > 0) {
    // POV-Ray's lights fade by 2 / (1 + (d / fade_distance)^2).
    fmt::print(out, "light_source {{ {} rgb {} fade_distance {:.9g} fade_power 2 }}\n",
               vector(light.position), vector(light.color / (2 * a.x)), std::sqrt(a.x / a.z));
  } else {
    fmt::print(out, "light_source {{ {} rgb {} }}\n", vector(light.position), vector(light.color));
  }
}

bool has_words_for(const scene::Light& light) {
  if (light.kind == scene::LightKind::directional) return true;
  const vec3& a = light.attenuation;
  const bool fades = a.z > 0 && a.x > 0 && a.y == 0, stays = a == vec3(1, 0, 0);
  return light.kind == scene::LightKind::point && std::isinf(light.range) && (fades || stays);
}

std::string material(std::uint32_t number) {
  return fmt::format("texture {{ T{0} }} interior {{ I{0} }}", number);
}

void write_triangle(std::ostream& out, const scene::Scene& scene, const scene::Triangle& t) {
  const bool smooth = t.normal[0] != scene::kNone;
  out << (smooth ? "smooth_triangle {" : "triangle {");
  for (std::size_t k = 0; k < 3; ++k) {
    out << (k > 0 ? "," : "") << vector(scene.vertices[t.vertex[k]]);
    if (smooth) out << ',' << vector(scene.normals[t.normal[k]]);
  }
  out << "}\n";
}

void write_shape(std::ostream& out, const scene::Sphere& s) {
  fmt::print(out, "sphere {{ {},{:.9g} {} }}\n", vector(s.center), s.radius, material(s.material));
}
void write_shape(std::ostream& out, const scene::Cone& c) {
  fmt::print(out, "cone {{ {},{:.9g},{},{:.9g} open {} }}\n", vector(c.base), c.base_radius, vector(c.apex),
             c.apex_radius, material(c.material));
}
void write_shape(std::ostream& out, const scene::Disc& d) {
  fmt::print(out, "disc {{ {},{},{:.9g} {} }}\n", vector(d.center), vector(d.normal), d.radius,
             material(d.material));
}
// POV-Ray's tori lie about the y axis: the matrix' rows are where x, y, z and the origin go.
void write_shape(std::ostream& out, const scene::Torus& t) {
  const dvec3 axis = glm::normalize(t.axis), other = std::abs(axis.x) < 0.5 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
  const dvec3 u = glm::normalize(glm::cross(axis, other)), v = glm::cross(u, axis);
  fmt::print(out, "torus {{ {:.9g},{:.9g} matrix <", t.major_radius, t.minor_radius);
  for (const dvec3& row : {u, axis, v}) fmt::print(out, "{:.9g},{:.9g},{:.9g},", row.x, row.y, row.z);
  fmt::print(out, "{:.9g},{:.9g},{:.9g}> {} }}\n", t.center.x, t.center.y, t.center.z, material(t.material));
}

template <class Kind>
constexpr bool kHasWord = requires(std::ostream& out, const typename Kind::Source& shape) {
  write_shape(out, shape);
};

// A mesh for each material: a texture per triangle would cost POV-Ray memory, and interiors are a mesh's own.
void write_meshes(std::ostream& out, const scene::Scene& scene) {
  std::vector<std::vector<const scene::Triangle*>> by_material(scene.materials.size());
  for (const scene::Triangle& t : scene.triangles) by_material[t.material].push_back(&t);
  for (std::uint32_t m = 0; m < by_material.size(); ++m) {
    if (by_material[m].empty()) continue;
    out << "mesh {\n";
    for (const scene::Triangle* t : by_material[m]) write_triangle(out, scene, *t);
    out << material(m) << " }\n";
  }
}

}  // namespace

bool pov_has_words_for(const scene::Scene& scene) {
  bool has_shapes = true;
  primitives::for_each_shape(
      [&](auto kind) { has_shapes &= kHasWord<decltype(kind)> || decltype(kind)::of(scene).empty(); });
  const auto glows = [](const scene::Material& m) { return largest(m.emission) > 0; };
  const bool plain = scene.sky.kind == scene::SkyKind::none && !(scene.camera && scene.camera->aperture > 0);
  return plain && has_shapes && std::all_of(scene.lights.begin(), scene.lights.end(), has_words_for) &&
         std::none_of(scene.materials.begin(), scene.materials.end(), glows);
}

void write_pov(std::ostream& out, const scene::Scene& scene, double aspect, int depth, double min_weight) {
  fmt::print(out,
             "#version 3.7;\nglobal_settings {{ assumed_gamma 1 max_trace_level {} adc_bailout {:.9g} }}\n",
             depth, min_weight);
  fmt::print(out, "background {{ rgb {} }}\n", vector(scene.background));
  write_camera(out, scene.camera.value_or(scene::Camera{}), aspect);
  for (const scene::Light& light : scene.lights) write_light(out, light);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) write_material(out, scene.materials[i], i);
  primitives::for_each_shape([&](auto kind) {
    if constexpr (kHasWord<decltype(kind)>)
      for (const auto& shape : decltype(kind)::of(scene)) write_shape(out, shape);
  });
  write_meshes(out, scene);
}

}  // namespace kdray::bench
