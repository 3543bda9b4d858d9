#include "flatten/flatten.h"

#include <bit>
#include <cmath>

#include "base/error.h"

namespace kdray::flatten {

namespace {

void set(float (&out)[3], const vec3& v) {
  for (int k = 0; k < 3; ++k) out[k] = v[k];
}

template <class T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

// The tree's nodes are in depth-first order with the lower child next to its parent, as the form wants; that they
// are is checked, since a wrong tree would otherwise be a wrong picture.
layout::KdNode pack(const kdtree::Node& node, std::size_t self) {
  if (node.is_leaf()) return {node.left, node.right << 2 | KDRAY_NODE_LEAF};
  if (node.left != self + 1)
    throw Error(ErrorCode::internal, "kd-tree: a lower child does not follow its parent");
  return {std::bit_cast<layout::u32>(node.split), node.right << 2 | node.axis};
}

std::vector<layout::KdNode> pack_nodes(const kdtree::Tree& tree) {
  if (tree.nodes.size() > KDRAY_NODE_MAX || tree.refs.size() > KDRAY_NODE_MAX)
    throw Error(ErrorCode::input, "the kd-tree has over 2^30 nodes or references; lower --tree-depth");
  std::vector<layout::KdNode> nodes(tree.nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = pack(tree.nodes[i], i);
  return nodes;
}

void pack_triangles(const scene::Scene& scene, const scene::Geometry& geometry, FlatScene& flat) {
  flat.triangles.reserve(geometry.triangles.size());
  for (const scene::TriangleGeometry& g : geometry.triangles) {
    const scene::Triangle& source = scene.triangles[g.source];
    layout::Triangle t{};
    for (int k = 0; k < 3; ++k) set(t.v[k], g.vertex[static_cast<std::size_t>(k)]);
    t.number = source.number;
    t.material = source.material;
    t.normals = KDRAY_NO_NORMALS;
    if (source.normal[0] != scene::kNone) {
      t.normals = static_cast<layout::u32>(flat.normals.size());
      layout::VertexNormals n{};
      for (std::size_t k = 0; k < 3; ++k) set(n.n[k], scene.normals[source.normal[k]]);
      flat.normals.push_back(n);
    }
    flat.triangles.push_back(t);
  }
}

layout::Sphere pack(const scene::SphereGeometry& g, const scene::Sphere& source) {
  layout::Sphere s{};
  set(s.center, g.center);
  s.radius = g.radius;
  s.number = source.number;
  s.material = source.material;
  return s;
}

layout::Cone pack(const scene::ConeGeometry& g, const scene::Cone& source) {
  layout::Cone c{};
  const dvec3 axis = dvec3(g.apex) - dvec3(g.base);
  const double height = glm::length(axis);
  set(c.base, g.base);
  set(c.axis, vec3(axis / height));
  c.base_radius = g.base_radius;
  c.height = static_cast<float>(height);
  c.slope = static_cast<float>((double(g.apex_radius) - double(g.base_radius)) / height);
  c.number = source.number;
  c.material = source.material;
  return c;
}

layout::Material pack(const scene::Material& m, const vec3& ambient_light) {
  layout::Material out{};
  set(out.unshadowed, m.emission + m.ambient * ambient_light);
  set(out.diffuse, m.diffuse);
  set(out.specular, m.specular);
  set(out.reflect, m.reflect);
  set(out.transmit, m.transmit);
  out.shine = m.shine;
  out.index = m.index;
  return out;
}

layout::u32 kind_of(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::directional:
      return KDRAY_LIGHT_DIRECTIONAL;
    case scene::LightKind::spot:
      return KDRAY_LIGHT_SPOT;
    default:
      return KDRAY_LIGHT_POINT;
  }
}

layout::Light pack(const scene::Light& light, const dvec3& center) {
  layout::Light out{};
  set(out.position, vec3(light.position - center));
  set(out.direction, vec3(light.direction));
  set(out.color, light.color);
  set(out.attenuation, light.attenuation);
  out.kind = kind_of(light.kind);
  out.range = static_cast<float>(light.range);
  out.cos_inner = light.cos_inner;
  out.cos_outer = light.cos_outer;
  return out;
}

}  // namespace

std::size_t FlatScene::bytes() const {
  return bytes_of(nodes) + bytes_of(refs) + bytes_of(triangles) + bytes_of(normals) + bytes_of(spheres) +
         bytes_of(cones) + bytes_of(materials) + bytes_of(lights);
}

FlatScene flatten(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree) {
  FlatScene flat;
  flat.nodes = pack_nodes(tree);
  flat.refs = tree.refs;
  pack_triangles(scene, geometry, flat);
  for (const scene::SphereGeometry& g : geometry.spheres)
    flat.spheres.push_back(pack(g, scene.spheres[g.source]));
  for (const scene::ConeGeometry& g : geometry.cones) flat.cones.push_back(pack(g, scene.cones[g.source]));
  for (const scene::Material& m : scene.materials) flat.materials.push_back(pack(m, scene.ambient));
  for (const scene::Light& l : scene.lights) flat.lights.push_back(pack(l, geometry.center));
  return flat;
}

}  // namespace kdray::flatten
