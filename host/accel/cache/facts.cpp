#include "accel/cache/entry.h"

#include <cstring>
#include <nlohmann/json.hpp>

namespace kdray::cache {

namespace {

// The structs are taken apart into all their members, so that one that is added can't be forgotten here.

using Json = nlohmann::json;

template <class Vec>
Json of(const Vec& v) {
  return {v.x, v.y, v.z};
}

template <class Vec>
void get(const Json& from, Vec& v) {
  for (int k = 0; k < 3; ++k) v[k] = from.at(static_cast<std::size_t>(k)).get<typename Vec::value_type>();
}

template <class T>
void get(const Json& from, std::optional<T>& value) {
  if (!from.is_null()) value = from.get<T>();
}

template <class T>
Json of(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

Json of(const std::optional<scene::Camera>& camera) {
  if (!camera) return nullptr;
  const auto& [eye, at, up, fov, hither, ortho_width, aperture, focus, aspect] = *camera;
  return {of(eye), of(at), of(up), fov, hither, ortho_width, aperture, focus, aspect};
}

void get(const Json& from, std::optional<scene::Camera>& camera) {
  if (from.is_null()) return;
  scene::Camera& c = camera.emplace();
  get(from.at(0), c.from);
  get(from.at(1), c.at);
  get(from.at(2), c.up);
  from.at(3).get_to(c.vertical_fov);
  from.at(4).get_to(c.hither);
  from.at(5).get_to(c.ortho_width);
  from.at(6).get_to(c.aperture);
  from.at(7).get_to(c.focus);
  from.at(8).get_to(c.aspect);
}

Json of(const std::vector<scene::Camera>& cameras) {
  Json list = Json::array();
  for (const scene::Camera& camera : cameras) list.push_back(of(std::optional(camera)));
  return list;
}

void get(const Json& from, std::vector<scene::Camera>& cameras) {
  for (const Json& camera : from) {
    std::optional<scene::Camera> read;
    get(camera, read);
    cameras.push_back(read.value());
  }
}

Json of(const scene::Framing& framing) {
  const auto& [camera, lights, box, studio, floor, illuminance] = framing;
  static_cast<void>(studio), static_cast<void>(floor);  // of scenes as they are seen, which are kept nowhere
  const Json shown = box.empty() ? Json() : Json{of(box.lo), of(box.hi)};  // infinities are no numbers
  return {camera, lights, shown, illuminance};
}

void get(const Json& from, scene::Framing& framing) {
  from.at(0).get_to(framing.camera);
  from.at(1).get_to(framing.lights);
  from.at(3).get_to(framing.illuminance);
  if (from.at(2).is_null()) return;
  get(from.at(2).at(0), framing.box.lo);
  get(from.at(2).at(1), framing.box.hi);
}

Json of(const scene::RenderSettings& s) {
  const auto& [width, height, depth, samples, min_weight] = s;
  return {of(width), of(height), of(depth), of(samples), of(min_weight)};
}

void get(const Json& from, scene::RenderSettings& s) {
  get(from.at(0), s.width);
  get(from.at(1), s.height);
  get(from.at(2), s.depth);
  get(from.at(3), s.samples);
  get(from.at(4), s.min_weight);
}

Json of(const std::vector<scene::FileRead>& files) {
  Json list = Json::array();
  for (const scene::FileRead& f : files)
    list.push_back(
        {f.path.string(), f.content ? Json{f.content->high, f.content->low} : Json(), f.only_named});
  return list;
}

void get(const Json& from, std::vector<scene::FileRead>& files) {
  for (const Json& f : from) {
    scene::FileRead& file = files.emplace_back();
    file.path = f.at(0).get<std::string>();
    if (!f.at(1).is_null())
      file.content = Hash{f.at(1).at(0).get<std::uint64_t>(), f.at(1).at(1).get<std::uint64_t>()};
    f.at(2).get_to(file.only_named);
  }
}

// Arrays as bytes: a file may have a run for each of its primitives.
template <class T>
Json of_bytes(const std::vector<T>& values) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(values.data());
  return Json::binary({first, first + values.size() * sizeof(T)});
}

template <class T>
void get_bytes(const Json& from, std::vector<T>& values) {
  const std::vector<std::uint8_t>& bytes = from.get_binary();
  values.resize(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
}

Json of(const std::shared_ptr<const scene::Names>& names) {
  if (!names) return nullptr;
  const auto& [texts, ends, materials, primitives, instances] = *names;
  return Json::array({texts, of_bytes(ends), of_bytes(materials), of_bytes(primitives), of_bytes(instances)});
}

void get(const Json& from, std::shared_ptr<const scene::Names>& names) {
  if (from.is_null()) return;
  scene::Names read;
  from.at(0).get_to(read.texts);
  get_bytes(from.at(1), read.ends);
  get_bytes(from.at(2), read.materials);
  get_bytes(from.at(3), read.primitives);
  get_bytes(from.at(4), read.instances);
  names = std::make_shared<const scene::Names>(std::move(read));
}

Json of(const kdtree::Statistics& s) {
  const auto& [inner_nodes, leaves, empty_leaves, references, groups, leaves_by_size, largest_leaf, max_depth,
               mean_leaf_depth, duplication, sah_cost, tight_cost] = s;
  return {inner_nodes,  leaves,    empty_leaves,    references,  groups,   leaves_by_size,
          largest_leaf, max_depth, mean_leaf_depth, duplication, sah_cost, tight_cost};
}

void get(const Json& from, kdtree::Statistics& s) {
  from.at(0).get_to(s.inner_nodes);
  from.at(1).get_to(s.leaves);
  from.at(2).get_to(s.empty_leaves);
  from.at(3).get_to(s.references);
  from.at(4).get_to(s.groups);
  from.at(5).get_to(s.leaves_by_size);
  from.at(6).get_to(s.largest_leaf);
  from.at(7).get_to(s.max_depth);
  from.at(8).get_to(s.mean_leaf_depth);
  from.at(9).get_to(s.duplication);
  from.at(10).get_to(s.sah_cost);
  from.at(11).get_to(s.tight_cost);
}

Json of(const prepare::Counts& c) {
  Json counts = {c.primitives};
  primitives::for_each_kind([&](auto kind) { counts.push_back(decltype(kind)::of(c)); });
  counts.push_back(c.zero_area);
  counts.push_back(c.instances);
  counts.push_back(c.instanced);
  return counts;
}

void get(const Json& from, prepare::Counts& c) {
  from.at(0).get_to(c.primitives);
  primitives::for_each_kind([&](auto kind) { from.at(1 + kind.kNumber).get_to(decltype(kind)::of(c)); });
  from.at(1 + primitives::kKinds).get_to(c.zero_area);
  from.at(2 + primitives::kKinds).get_to(c.instances);
  from.at(3 + primitives::kKinds).get_to(c.instanced);
}

}  // namespace

std::string to_bytes(const prepare::Prepared& p) {
  const auto& [name, vertices, normals, triangles, KDRAY_SHAPES(KDRAY_KIND_PLURAL) meshes, instances,
               materials, texturing, lights, unlit, camera, cameras, framing, background, sky, ambient,
               settings, warnings, files, load_options, names] = p.settings;
  const auto& [scene, geometry, counts, features, tree_depth, tree_nodes, tree, flat, wide, doubles,
               placed_meshes, tree_options, seconds] = p;
  static_cast<void>(doubles),
      static_cast<void>(placed_meshes);  // of scenes that programs make, which are kept in no file
  const Json facts = {{"name", name},
                      {"warnings", warnings},
                      {"names", of(names)},
                      {"files", of(files)},
                      {"camera", of(camera)},
                      {"cameras", of(cameras)},
                      {"framing", of(framing)},
                      {"background", of(background)},
                      {"sky", {static_cast<int>(sky.kind), sky.brightest}},  // the rest is flat
                      {"ambient", of(ambient)},
                      {"settings", of(settings)},
                      {"center", of(geometry.space.center)},
                      {"scale", geometry.space.scale},
                      {"lo", of(geometry.bounds.lo)},
                      {"hi", of(geometry.bounds.hi)},
                      {"dropped", geometry.dropped_degenerate},
                      {"counts", of(counts)},
                      {"features", features},
                      {"tree_depth", tree_depth},
                      {"tree_nodes", tree_nodes},
                      {"tree", of(tree)},
                      {"block", wide.block},
                      {"widen", wide.widen},
                      {"stack_size", wide.stack_size}};
  std::string bytes;
  Json::to_cbor(facts, bytes);
  return bytes;
}

void from_bytes(std::string_view bytes, prepare::Prepared& p) {
  const Json facts = Json::from_cbor(bytes);
  scene::Scene& s = p.settings;
  facts.at("name").get_to(s.name);
  facts.at("warnings").get_to(s.warnings);
  get(facts.at("names"), s.names);
  get(facts.at("files"), s.files);
  get(facts.at("camera"), s.camera);
  get(facts.at("cameras"), s.cameras);
  get(facts.at("framing"), s.framing);
  get(facts.at("background"), s.background);
  s.sky.kind = static_cast<scene::SkyKind>(facts.at("sky").at(0).get<int>());
  facts.at("sky").at(1).get_to(s.sky.brightest);
  get(facts.at("ambient"), s.ambient);
  get(facts.at("settings"), s.settings);
  get(facts.at("center"), p.geometry.space.center);
  facts.at("scale").get_to(p.geometry.space.scale);
  get(facts.at("lo"), p.geometry.bounds.lo);
  get(facts.at("hi"), p.geometry.bounds.hi);
  facts.at("dropped").get_to(p.geometry.dropped_degenerate);
  get(facts.at("counts"), p.counts);
  facts.at("features").get_to(p.features);
  facts.at("tree_depth").get_to(p.tree_depth);
  facts.at("tree_nodes").get_to(p.tree_nodes);
  get(facts.at("tree"), p.tree);
  facts.at("block").get_to(p.wide.block);
  facts.at("widen").get_to(p.wide.widen);
  facts.at("stack_size").get_to(p.wide.stack_size);
}

}  // namespace kdray::cache
