#include "accel/flatten/flatten.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "accel/flatten/textures.h"
#include "base/error.h"
#include "scene/primitives/shape_tools.h"
#include "scene/primitives/shapes.h"

namespace kdray::flatten {

namespace {

constexpr std::size_t kGrain = 8192;  // items that one task packs

using primitives::pack, primitives::set;

// The nodes of the binary form, which knows planes alone: a cell's groups are one leaf.
struct BinaryNodes {
  RawVector<std::uint32_t> nodes;   // of the tree, in its order
  RawVector<std::uint32_t> places;  // of the tree's nodes among them

  explicit BinaryNodes(const kdtree::Tree& tree) : places(tree.nodes.size()) {
    nodes.reserve(tree.nodes.size());
    for (std::uint32_t i = 0; i < tree.nodes.size();) {
      places[i] = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back(i);
      i = tree.nodes[i].has_groups() ? kdtree::last_leaf(tree, i) + 1 : i + 1;
    }
  }
};

// The tree's nodes are in depth-first order with the lower child next to its parent, as the form wants; that
// they are is checked, since a wrong tree would otherwise be a wrong picture.
layout::KdNode pack(const kdtree::Tree& tree, std::uint32_t self, const BinaryNodes& all) {
  const kdtree::Node& node = tree.nodes[self];
  if (node.is_leaf() || node.has_groups()) {
    const kdtree::RefRun run = kdtree::refs_of_cell(tree, self);
    return {run.first, run.n << 2 | KDRAY_NODE_LEAF};
  }
  if (node.left != self + 1)
    throw Error(ErrorCode::internal, "kd-tree: a lower child does not follow its parent");
  return {std::bit_cast<layout::u32>(node.split), all.places[node.right] << 2 | node.axis};
}

// out[i] = value(i), with all cores.
template <class T, class Value>
Array<T> filled(std::size_t n, const Value& value) {
  Array<T> out(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) out[i] = value(i);
  });
  return out;
}

void pack_binary(const kdtree::Tree& tree, FlatScene& flat) {
  if (tree.nodes.size() > KDRAY_NODE_MAX || tree.refs.size() > KDRAY_NODE_MAX)
    throw Error(ErrorCode::input, "the kd-tree has over 2^30 nodes or references; lower --tree-depth");
  const BinaryNodes all(tree);
  flat.nodes =
      filled<layout::KdNode>(all.nodes.size(), [&](std::size_t i) { return pack(tree, all.nodes[i], all); });
  flat.refs = filled<layout::u32>(tree.refs.size(), [&](std::size_t i) { return tree.refs[i]; });
}

layout::VertexNormals pack_normals(const scene::Scene& scene, const scene::Triangle& source) {
  layout::VertexNormals n{};
  for (std::size_t k = 0; k < 3; ++k) set(n.n[k], scene.normals[source.normal[k]]);
  return n;
}

// A zero-area triangle to which the file gives no normals has its neighbour's at all corners.
void pack_zero_area(const scene::Scene& scene, const scene::Geometry& geometry,
                    Array<layout::VertexNormals>& normals) {
  for (const scene::ZeroAreaTriangle& found : geometry.zero_area) {
    if (scene.triangles[geometry.sources[found.triangle]].normal[0] != scene::kNone) continue;
    layout::VertexNormals n{};
    for (auto& at_corner : n.n) set(at_corner, found.normal);
    normals[geometry.triangles[found.triangle].normals & KDRAY_NORMALS_MASK] = n;
  }
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
  out.maps = m.maps;
  return out;
}

layout::u32 kind_of(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::directional:
      return KDRAY_LIGHT_DIRECTIONAL;
    case scene::LightKind::spot:
      return KDRAY_LIGHT_SPOT;
    case scene::LightKind::rectangle:
      return KDRAY_LIGHT_RECTANGLE;
    case scene::LightKind::sphere:
      return KDRAY_LIGHT_SPHERE;
    case scene::LightKind::disc:
      return KDRAY_LIGHT_DISC;
    default:
      return KDRAY_LIGHT_POINT;
  }
}

float within_float(double value) {
  return static_cast<float>(std::min(value, double{std::numeric_limits<float>::max()}));
}

// Fall-off for local distances: a.x + a.y*d + a.z*d^2 with d = local / scale.
vec3 local_attenuation(const dvec3& a, const LocalSpace& space) {
  return {within_float(a.x), within_float(space.world_length(a.y)),
          within_float(space.world_length(space.world_length(a.z)))};
}

// Beyond this, in local lengths, a light's direction is the same all over the scene, and products of its
// distance may leave the range of float.
constexpr double kFarLight = 0x1p40 * kLocalReach;

// A light so far away is taken to be at kFarLight, in its direction, and to have lost what its true distance
// costs.
void bring_near(layout::Light& out, const scene::Light& light, const dvec3& way, const LocalSpace& space) {
  const double distance = safe_length(way);
  const dvec3& a = light.attenuation;
  const double fall_off = a.x + a.y * distance + a.z * distance * distance;
  const bool reaches = distance <= light.range && std::isfinite(fall_off);
  set(out.position, vec3(safe_normalize(way) * kFarLight));
  set(out.color, reaches ? vec3(dvec3(light.color) / fall_off) : vec3(0));
  set(out.attenuation, vec3(1, 0, 0));
  out.range = std::numeric_limits<float>::infinity();
  const double nearer = kFarLight / space.local_length(distance);  // it looks as large as before
  for (int k = 0; k < 3; ++k) {
    out.across[k] = static_cast<float>(out.across[k] * nearer);
    out.down[k] = static_cast<float>(out.down[k] * nearer);
  }
  out.radius = static_cast<float>(out.radius * nearer);
}

float near_enough(double length) {
  return static_cast<float>(std::clamp(length, -kFarLight, kFarLight));
}

// Kernels take half of a rectangle's edges.
void pack_area(layout::Light& out, const scene::Light& light, const LocalSpace& space) {
  if (!scene::has_area(light.kind)) return;
  const double share = light.kind == scene::LightKind::rectangle ? 0.5 : 1;
  for (int k = 0; k < 3; ++k) {
    out.across[k] = near_enough(space.local_length(light.across[k] * share));
    out.down[k] = near_enough(space.local_length(light.down[k] * share));
  }
  out.radius = near_enough(space.local_length(light.radius));
}

layout::Light pack(const scene::Light& light, const LocalSpace& space) {
  layout::Light out{};
  const dvec3 position = space.local(light.position);
  set(out.position, vec3(position));
  set(out.direction, vec3(light.direction));
  set(out.color, light.color);
  set(out.attenuation, local_attenuation(light.attenuation, space));
  out.kind = kind_of(light.kind);
  out.range = static_cast<float>(space.local_length(light.range));
  out.cos_inner = light.cos_inner;
  out.cos_outer = light.cos_outer;
  pack_area(out, light, space);
  if (light.kind != scene::LightKind::directional && largest_component(position) > kFarLight)
    bring_near(out, light, light.position - space.center, space);
  return out;
}

}  // namespace

std::size_t FlatScene::bytes() const {
  std::size_t sum = 0;
  for_each_flat_array(*this, [&](const auto& array) { sum += array.bytes(); });
  return sum;
}

FlatScene flatten(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree,
                  bool binary_form) {
  FlatScene flat;
  if (binary_form) pack_binary(tree, flat);
  flat.triangles = geometry.triangles;
  flat.normals = pack_normals(scene, geometry);
  primitives::for_each_shape([&](auto kind) {
    using Kind = decltype(kind);
    const auto& shapes = Kind::of(geometry);
    Kind::of(flat) = filled<typename Kind::Layout>(shapes.size(), [&](std::size_t i) {
      const auto& source = Kind::of(scene)[shapes[i].source];
      typename Kind::Layout packed = pack(shapes[i]);
      packed.number = source.number;
      packed.material = source.material;
      return packed;
    });
  });
  flat.materials = pack_materials(scene);
  pack_textures_of(scene, geometry, flat);
  flat.lights = pack_lights(scene, geometry.space);
  pack_sky(scene.sky, flat);
  return flat;
}

Array<layout::VertexNormals> pack_normals(const scene::Scene& scene, const scene::Geometry& geometry) {
  Array<layout::VertexNormals> normals(geometry.n_smooth);
  if (normals.empty()) return normals;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, geometry.triangles.size(), kGrain),
                    [&](const auto& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        const layout::u32 place = geometry.triangles[i].normals & KDRAY_NORMALS_MASK;
                        const scene::Triangle& source = scene.triangles[geometry.sources[i]];
                        if (place != KDRAY_NO_NORMALS && source.normal[0] != scene::kNone)
                          normals[place] = pack_normals(scene, source);
                      }
                    });
  pack_zero_area(scene, geometry, normals);
  return normals;
}

Array<layout::Material> pack_materials(const scene::Scene& scene) {
  return filled<layout::Material>(scene.materials.size(),
                                  [&](std::size_t i) { return pack(scene.materials[i], scene.ambient); });
}

Array<layout::Light> pack_lights(const scene::Scene& scene, const LocalSpace& space) {
  return filled<layout::Light>(scene.lights.size(),
                               [&](std::size_t i) { return pack(scene.lights[i], space); });
}

}  // namespace kdray::flatten
