#include "pictures/stored.h"

#include <cmath>

#include "accel/flatten/flatten.h"
#include "accel/kdtree/build.h"
#include "scene/model/geometry.h"

namespace kdray::test {

namespace {

vec3 color(const float (&v)[3]) {
  return {v[0], v[1], v[2]};
}

void add_triangles(const flatten::FlatScene& flat, scene::Scene& out) {
  for (const layout::Triangle& t : flat.triangles) {
    scene::Triangle triangle;
    triangle.material = t.material;
    triangle.number = t.number;
    for (std::uint32_t i = 0; i < 3; ++i) {
      triangle.vertex[i] = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back(dvec3_of(t.v[i]));
      if (t.normals == KDRAY_NO_NORMALS) continue;
      triangle.normal[i] = static_cast<std::uint32_t>(out.normals.size());
      out.normals.push_back(color(flat.normals[t.normals & KDRAY_NORMALS_MASK].n[i]));
    }
    out.triangles.push_back(triangle);
  }
}

void add_materials(const flatten::FlatScene& flat, scene::Scene& out) {
  out.ambient = vec3(0);  // it is in what a material shows without light
  for (const layout::Material& m : flat.materials)
    out.materials.push_back({.emission = color(m.unshadowed),
                             .ambient = vec3(0),
                             .diffuse = color(m.diffuse),
                             .specular = color(m.specular),
                             .reflect = color(m.reflect),
                             .transmit = color(m.transmit),
                             .shine = m.shine,
                             .index = m.index});
}

}  // namespace

Stored as_stored(const scene::Scene& scene) {
  const scene::Geometry geometry = scene::make_geometry(scene);
  const flatten::FlatScene flat = flatten::flatten(scene, geometry, kdtree::build(geometry));
  Stored stored;
  stored.space = geometry.space;
  scene::Scene& out = stored.model;
  add_triangles(flat, out);
  primitives::for_each_shape([&](auto kind) {
    for (const auto& shape : decltype(kind)::of(flat)) decltype(kind)::of(out).push_back(as_told(shape));
  });
  add_materials(flat, out);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    scene::Light light = scene.lights[i];
    light.position = dvec3_of(flat.lights[i].position);
    light.direction = glm::normalize(dvec3_of(flat.lights[i].direction));
    light.range = flat.lights[i].range;
    light.attenuation = dvec3_of(flat.lights[i].attenuation);
    out.lights.push_back(light);
  }
  out.background = scene.background;
  out.camera = scene.camera;
  out.camera->from = geometry.space.local(out.camera->from);
  out.camera->at = geometry.space.local(out.camera->at);
  out.camera->hither = geometry.space.local_length(out.camera->hither);
  return stored;
}

scene::Camera straight_camera(double height, double distance) {
  scene::Camera camera;
  camera.from = {0, height, distance};
  camera.at = {0, height, 0};
  camera.vertical_fov = 2 * std::atan(0.5);
  return camera;
}

}  // namespace kdray::test
