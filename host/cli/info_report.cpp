#include "cli/info_report.h"

#include <array>

namespace kdray::cli {

namespace {

template <class Vec>
Json as_json(const Vec& v) {
  return Json::array({v.x, v.y, v.z});
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

Json material_report(const scene::Material& m, std::uint64_t uses) {
  return {{"primitives", uses},
          {"emission", as_json(m.emission)},
          {"ambient", as_json(m.ambient)},
          {"diffuse", as_json(m.diffuse)},
          {"specular", as_json(m.specular)},
          {"shine", m.shine},
          {"reflect", as_json(m.reflect)},
          {"transmit", as_json(m.transmit)},
          {"index", m.index}};
}

Json materials_report(const scene::Scene& scene) {
  std::vector<std::uint64_t> uses(scene.materials.size());
  const auto count = [&uses](const auto& primitives) {
    for (const auto& p : primitives)
      if (p.material < uses.size()) ++uses[p.material];
  };
  count(scene.triangles), count(scene.spheres), count(scene.cones);
  Json list = Json::array();
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    list.push_back(material_report(scene.materials[i], uses[i]));
  return list;
}

Json lights_report(const scene::Scene& scene) {
  static constexpr std::array<const char*, 3> kKinds = {"point", "directional", "spot"};
  Json list = Json::array();
  for (const scene::Light& l : scene.lights) {
    Json light = {{"kind", kKinds[static_cast<std::size_t>(l.kind)]}, {"color", as_json(l.color)}};
    if (l.kind != scene::LightKind::directional) light["position"] = as_json(l.position);
    if (l.kind != scene::LightKind::point) light["direction"] = as_json(l.direction);
    list.push_back(std::move(light));
  }
  return list;
}

Json bounds_report(const scene::Scene& scene) {
  const DBox bounds = scene.bounds();
  if (bounds.empty()) return nullptr;  // an empty scene has none; infinities are no JSON
  return {{"min", as_json(bounds.lo)}, {"max", as_json(bounds.hi)}};
}

Json camera_report(const scene::Scene& scene) {
  if (!scene.camera) return nullptr;
  constexpr double kDegrees = 57.29577951308232;
  const scene::Camera& c = *scene.camera;
  return {{"from", as_json(c.from)},
          {"at", as_json(c.at)},
          {"up", as_json(c.up)},
          {"vertical_fov_degrees", c.vertical_fov * kDegrees},
          {"hither", c.hither}};
}

}  // namespace

Json scene_report(const scene::Scene& scene, const scene::Geometry& geometry) {
  Json report;
  report["scene"] = scene.name;
  report["primitives"] = {{"total", scene.primitive_count()},
                          {"triangles", scene.triangles.size()},
                          {"spheres", scene.spheres.size()},
                          {"cones", scene.cones.size()},
                          {"dropped_degenerate", geometry.dropped_degenerate},
                          {"vertices", scene.vertices.size()},
                          {"normals", scene.normals.size()}};
  report["bounds"] = bounds_report(scene);
  report["camera"] = camera_report(scene);
  report["background"] = as_json(scene.background);
  report["lights"] = lights_report(scene);
  report["materials"] = materials_report(scene);
  report["warnings"] = scene.warnings;
  return report;
}

Json tree_report(const kdtree::Tree& tree, const kdtree::Statistics& s) {
  return {{"nodes", tree.nodes.size()},
          {"inner_nodes", s.inner_nodes},
          {"leaves", s.leaves},
          {"empty_leaves", s.empty_leaves},
          {"references", s.references},
          {"duplication", s.duplication},
          {"leaves_by_size", s.leaves_by_size},
          {"largest_leaf", s.largest_leaf},
          {"max_depth", s.max_depth},
          {"mean_leaf_depth", s.mean_leaf_depth},
          {"sah_cost", s.sah_cost}};
}

Json memory_report(const scene::Scene& scene, const scene::Geometry& geometry, const kdtree::Tree& tree) {
  return {{"scene_bytes", bytes_of(scene.vertices) + bytes_of(scene.normals) + bytes_of(scene.triangles) +
                              bytes_of(scene.spheres) + bytes_of(scene.cones) + bytes_of(scene.materials) +
                              bytes_of(scene.lights)},
          {"geometry_bytes",
           bytes_of(geometry.triangles) + bytes_of(geometry.spheres) + bytes_of(geometry.cones)},
          {"tree_bytes", bytes_of(tree.nodes) + bytes_of(tree.refs)},
          {"process_peak_bytes", peak_memory()}};
}

}  // namespace kdray::cli
