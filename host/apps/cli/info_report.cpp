#include "apps/cli/info_report.h"

#include <array>
#include <utility>

namespace kdray::cli {

namespace {

template <class Vec>
Json as_json(const Vec& v) {
  return Json::array({v.x, v.y, v.z});
}

template <class Values>
std::uint64_t bytes_of(const Values& v) {
  return v.size() * sizeof(*v.data());
}

template <class Holder>
void add_kinds(const Holder& holder, Json& arrays) {
  primitives::for_each_kind([&](auto kind) { arrays[kind.kNames] = bytes_of(decltype(kind)::of(holder)); });
}

// The structs are taken apart into all their arrays, so that one that is added can't be forgotten.

Json texturing_arrays(const scene::Texturing& texturing) {
  const auto& [colors, texcoords, tangents, material_maps, textures, pictures] = texturing;
  std::uint64_t texels = 0;
  for (const auto& picture : pictures) texels += picture->texels.bytes();
  return {{"corner_colors", bytes_of(colors)},
          {"texcoords", bytes_of(texcoords[0]) + bytes_of(texcoords[1]) + bytes_of(tangents)},
          {"material_maps", bytes_of(material_maps)},
          {"textures", bytes_of(textures)},
          {"pictures", texels}};
}

Json scene_arrays(const scene::Scene& scene) {
  const auto& [name, vertices, normals, triangles, KDRAY_SHAPES(KDRAY_KIND_PLURAL) meshes, instances,
               materials, texturing, lights, unlit, camera, cameras, framing, background, sky, ambient,
               settings, warnings, files, load_options, names] = scene;
  Json arrays = {{"vertices", bytes_of(vertices)}, {"normals", bytes_of(normals)}};
  add_kinds(scene, arrays);
  arrays.update({{"materials", bytes_of(materials)}, {"lights", bytes_of(lights)}});
  if (!texturing.material_maps.empty()) arrays.update(texturing_arrays(texturing));
  if (sky.picture) arrays["sky"] = bytes_of(sky.picture->rgb);
  if (names) arrays["names"] = names->bytes();
  return arrays;
}

Json geometry_arrays(const scene::Geometry& geometry) {
  const auto& [space, triangles, sources, n_smooth, zero_area, KDRAY_SHAPES(KDRAY_KIND_PLURAL) bounds,
               dropped, lost, fine] = geometry;
  // Its triangles are the flat form's.
  Json arrays = {{"sources", bytes_of(sources)}, {"stitches", bytes_of(zero_area)}};
  primitives::for_each_shape(
      [&](auto kind) { arrays[kind.kNames] = bytes_of(decltype(kind)::of(geometry)); });
  return arrays;
}

Json tree_arrays(const kdtree::Tree& tree) {
  const auto& [nodes, refs, contents, bounds, max_depth] = tree;
  return {{"nodes", bytes_of(nodes)}, {"references", bytes_of(refs)}, {"contents", bytes_of(contents)}};
}

Json flat_arrays(const flatten::FlatScene& flat) {
  const auto& [nodes, refs, triangles, normals, KDRAY_SHAPES(KDRAY_KIND_PLURAL) instances, materials,
               material_maps, textures, texels, texcoords, corner_colors, lights, sky, sky_colors] = flat;
  Json arrays = {{"nodes", bytes_of(nodes)}, {"references", bytes_of(refs)}};
  add_kinds(flat, arrays);
  arrays.update(
      {{"normals", bytes_of(normals)}, {"materials", bytes_of(materials)}, {"lights", bytes_of(lights)}});
  if (!material_maps.empty())
    arrays.update({{"material_maps", bytes_of(material_maps)},
                   {"textures", bytes_of(textures)},
                   {"texels", bytes_of(texels)},
                   {"texcoords", bytes_of(texcoords)},
                   {"corner_colors", bytes_of(corner_colors)}});
  if (!sky.empty()) arrays["sky"] = bytes_of(sky) + bytes_of(sky_colors);
  return arrays;
}

Json wide_arrays(const flatten::WideForm& wide) {
  Json arrays = {{"nodes", bytes_of(wide.nodes)}};
  primitives::for_each_kind([&](auto kind) {
    arrays[std::string(kind.kName) + "_blocks"] = bytes_of(decltype(kind)::blocks_of(wide));
  });
  return arrays;
}

std::uint64_t sum(const Json& arrays) {
  std::uint64_t bytes = 0;
  for (const Json& array : arrays) bytes += array.get<std::uint64_t>();
  return bytes;
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
  primitives::for_each_kind([&](auto kind) { count(decltype(kind)::of(scene)); });
  Json list = Json::array();
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    list.push_back(material_report(scene.materials[i], uses[i]));
    const std::string_view name = scene.names ? scene.names->of_material(static_cast<std::uint32_t>(i)) : "";
    if (!name.empty()) list.back()["name"] = name;
  }
  return list;
}

// Adds up the numbers in the runs of each name; runs of names that there are not are left out.
std::vector<std::uint64_t> counts_of(const std::vector<scene::NameRun>& runs, std::size_t n_names) {
  std::vector<std::uint64_t> counts(n_names);
  for (std::size_t i = 0; i + 1 < runs.size(); ++i)
    if (runs[i].name < n_names) counts[runs[i].name] += runs[i + 1].first - runs[i].first;
  return counts;
}

Json lights_report(const scene::Scene& scene) {
  static constexpr std::array<const char*, 6> kKinds = {"point",     "directional", "spot",
                                                        "rectangle", "sphere",      "disc"};
  Json list = Json::array();
  for (const scene::Light& l : scene.lights) {
    Json light = {{"kind", kKinds[static_cast<std::size_t>(l.kind)]}, {"color", as_json(l.color)}};
    if (l.kind != scene::LightKind::directional) light["position"] = as_json(l.position);
    if (l.kind == scene::LightKind::directional || l.kind == scene::LightKind::spot)
      light["direction"] = as_json(l.direction);
    if (l.kind == scene::LightKind::sphere) light["radius"] = l.radius;
    if (l.kind == scene::LightKind::rectangle || l.kind == scene::LightKind::disc)
      light["across"] = as_json(l.across), light["down"] = as_json(l.down);
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
          {"vertical_fov_degrees", c.ortho_width > 0 ? Json() : Json(c.vertical_fov * kDegrees)},
          {"ortho_width", c.ortho_width > 0 ? Json(c.ortho_width) : Json()},
          {"hither", c.hither},
          {"aperture", c.aperture},
          {"focus", c.focus > 0 ? c.focus : safe_length(c.at - c.from)},
          {"in_file", scene.cameras.size()},
          {"made_up", scene.framing.camera}};
}

// Reports a colour, or what is there instead.
Json background_report(const scene::Scene& scene) {
  const scene::Sky& sky = scene.sky;
  if (sky.kind == scene::SkyKind::none) return as_json(scene.background);
  if (sky.kind == scene::SkyKind::gradient) return {{"type", "gradient"}, {"stops", sky.stops.size()}};
  Json report = {{"type", "picture"}, {"brightest", sky.brightest}};
  if (sky.picture)
    report.update({{"file", sky.picture->name}, {"size", {sky.picture->width, sky.picture->height}}});
  return report;
}

}  // namespace

Parts parts_report(const scene::Scene& scene, std::size_t most) {
  Parts parts;
  if (!scene.names) return parts;
  const scene::Names& names = *scene.names;
  const auto n_primitives = counts_of(names.primitives, names.ends.size());
  const auto n_instances = counts_of(names.instances, names.ends.size());
  for (std::uint32_t i = 1; i < names.ends.size(); ++i) {
    if (n_primitives[i] == 0 && n_instances[i] == 0) continue;
    if (++parts.count > most) continue;
    parts.first.push_back({{"name", names.text(i)}, {"primitives", n_primitives[i]}});
    if (n_instances[i] > 0) parts.first.back()["instances"] = n_instances[i];
  }
  return parts;
}

Json scene_report(const scene::Scene& scene, const scene::Geometry& geometry, Json parts) {
  Json report;
  report["scene"] = scene.name;
  Json counts = {{"total", scene.primitive_count()}};
  primitives::for_each_kind([&](auto kind) { counts[kind.kNames] = decltype(kind)::of(scene).size(); });
  counts.update({{"stitches", geometry.zero_area.size()},
                 {"dropped_degenerate", geometry.dropped_degenerate},
                 {"vertices", scene.vertices.size()},
                 {"normals", scene.normals.size()}});
  report["primitives"] = counts;
  report["bounds"] = bounds_report(scene);
  report["camera"] = camera_report(scene);
  report["background"] = background_report(scene);
  report["lights"] = lights_report(scene);
  report["lights_made_up"] = scene.framing.lights;
  report["materials"] = materials_report(scene);
  report["parts"] = std::move(parts);
  report["warnings"] = scene.warnings;
  if (const std::string warning = scene::range_warning(geometry); !warning.empty())
    report["warnings"].push_back(warning);
  return report;
}

Json tree_report(const kdtree::Statistics& s) {
  return {{"nodes", s.inner_nodes + s.leaves},
          {"inner_nodes", s.inner_nodes},
          {"leaves", s.leaves},
          {"empty_leaves", s.empty_leaves},
          {"groups", s.groups},
          {"references", s.references},
          {"duplication", s.duplication},
          {"leaves_by_size", s.leaves_by_size},
          {"largest_leaf", s.largest_leaf},
          {"max_depth", s.max_depth},
          {"mean_leaf_depth", s.mean_leaf_depth},
          {"sah_cost", s.sah_cost},
          {"tight_cost", s.tight_cost}};
}

Json memory_report(const MemoryUsers& m) {
  const Json arrays = {{"scene", scene_arrays(m.scene)},
                       {"geometry", geometry_arrays(m.geometry)},
                       {"tree", tree_arrays(m.tree)},
                       {"flat", flat_arrays(m.flat)},
                       {"wide", wide_arrays(m.wide)}};
  return {{"scene_bytes", sum(arrays["scene"])},
          {"geometry_bytes", sum(arrays["geometry"])},
          {"tree_bytes", sum(arrays["tree"])},
          {"flat_bytes", sum(arrays["flat"])},
          {"wide_bytes", sum(arrays["wide"])},
          {"final_bytes", sum(arrays["flat"]) + sum(arrays["wide"])},
          {"build_peak_bytes", m.build_peak ? Json(*m.build_peak) : Json()},
          {"process_peak_bytes", m.process_peak},
          {"arrays", arrays}};
}

}  // namespace kdray::cli
