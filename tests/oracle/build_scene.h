// What    Tiny scenes put together in code, for tests of one effect each.
#pragma once

#include "scene/model/scene.h"

namespace kdray::oracle {

// Adds primitives in file order, each with a material of its own.
class SceneBuilder {
 public:
  SceneBuilder() {
    scene_.ambient = vec3(0);
    scene_.camera = scene::Camera{};
  }

  SceneBuilder& sphere(const dvec3& center, double radius, const scene::Material& m) {
    scene_.spheres.push_back({center, radius, material(m), next()});
    return *this;
  }
  SceneBuilder& cone(const dvec3& base, double r0, const dvec3& apex, double r1, const scene::Material& m) {
    scene_.cones.push_back({base, apex, r0, r1, material(m), next()});
    return *this;
  }
  SceneBuilder& disc(const dvec3& center, const dvec3& normal, double radius, const scene::Material& m) {
    scene_.discs.push_back({center, normal, radius, material(m), next()});
    return *this;
  }
  // Counter-clockwise seen from the front.
  SceneBuilder& triangle(const dvec3& a, const dvec3& b, const dvec3& c, const scene::Material& m) {
    scene_.triangles.push_back(
        {corners(a, b, c), {scene::kNone, scene::kNone, scene::kNone}, material(m), next()});
    return *this;
  }
  SceneBuilder& smooth(const dvec3& a, const dvec3& b, const dvec3& c, const vec3& na, const vec3& nb,
                       const vec3& nc, const scene::Material& m) {
    const auto first = static_cast<std::uint32_t>(scene_.normals.size());
    for (const vec3& n : {na, nb, nc}) scene_.normals.push_back(glm::normalize(n));
    scene_.triangles.push_back({corners(a, b, c), {first, first + 1, first + 2}, material(m), next()});
    return *this;
  }
  // A parallelogram of two triangles: corner, corner + x, corner + x + y, corner + y.
  SceneBuilder& quad(const dvec3& corner, const dvec3& x, const dvec3& y, const scene::Material& m) {
    triangle(corner, corner + x, corner + x + y, m);
    return triangle(corner, corner + x + y, corner + y, m);
  }
  SceneBuilder& light(const scene::Light& l) {
    scene_.lights.push_back(l);
    return *this;
  }
  SceneBuilder& light(const dvec3& position, const vec3& color = vec3(1)) {
    scene::Light l;
    l.position = position;
    l.color = color;
    return light(l);
  }
  SceneBuilder& camera(const dvec3& from, const dvec3& at, double vertical_fov = 0.7,
                       const dvec3& up = {0, 1, 0}) {
    scene_.camera = scene::Camera{from, at, up, vertical_fov, 0};
    return *this;
  }
  SceneBuilder& background(const vec3& color) {
    scene_.background = color;
    return *this;
  }
  SceneBuilder& ambient(const vec3& color) {
    scene_.ambient = color;
    return *this;
  }
  // Anything else.
  template <class Change>
  SceneBuilder& change(const Change& change_scene) {
    change_scene(scene_);
    return *this;
  }
  const scene::Scene& scene() const { return scene_; }

 private:
  std::uint32_t next() const { return scene_.primitive_count(); }
  std::uint32_t material(const scene::Material& m) {
    scene_.materials.push_back(m);
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
  }
  std::array<std::uint32_t, 3> corners(const dvec3& a, const dvec3& b, const dvec3& c) {
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (const dvec3& p : {a, b, c}) scene_.vertices.push_back(p);
    return {first, first + 1, first + 2};
  }

  scene::Scene scene_;
};

inline scene::Material matte(const vec3& color) {
  scene::Material m;
  m.diffuse = color;
  return m;
}
inline scene::Material mirror(const vec3& share = vec3(1)) {
  scene::Material m;
  m.reflect = share;
  return m;
}
inline scene::Material glass(float index, const vec3& transmit = vec3(1), const vec3& reflect = vec3(0)) {
  scene::Material m;
  m.transmit = transmit;
  m.reflect = reflect;
  m.index = index;
  return m;
}
inline scene::Material glowing(const vec3& color) {
  scene::Material m;
  m.emission = color;
  return m;
}

}  // namespace kdray::oracle
