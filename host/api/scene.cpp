#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "api/scene_impl.h"
#include "base/timer.h"
#include "device/opencl/platform.h"
#include "engine/query/queries.h"
#include "scene/import/load.h"
#include "scene/model/added_geometry.h"

namespace kdray {

namespace {

[[noreturn]] void no_such(GeometryId id) {
  throw Error(ErrorCode::usage, fmt::format("there is no geometry {}", id));
}

DBox bounds_of(const prepare::Prepared& prepared) {
  DBox local;
  if (const auto& doubles = prepared.doubles) {
    for (const auto& corners : doubles->corners)
      for (const std::uint32_t corner : corners) local.grow(doubles->vertices[corner]);
    primitives::for_each_shape([&](auto kind) {
      for (const auto& shape : decltype(kind)::of(*doubles)) local.grow(primitives::bounds_of(shape));
    });
  } else if (const Box& floats = prepared.geometry.bounds; !floats.empty()) {
    local = {dvec3(floats.lo), dvec3(floats.hi)};
  }
  if (local.empty()) return local;
  const LocalSpace& space = prepared.geometry.space;
  return {space.world(local.lo), space.world(local.hi)};
}

}  // namespace

scene::AddedGeometry& Scene::Impl::added(GeometryId id) {
  if (id < first_added && !file) no_such(id);
  if (id < first_added) throw Error(ErrorCode::usage, "geometry 0 is the file's: it can't be changed");
  const std::size_t i = id - first_added;
  if (i >= geometries.size() || !geometries[i]) no_such(id);
  return *geometries[i];
}

GeometryId Scene::Impl::add(scene::AddedGeometry&& geometry, const GeometryOptions& options) {
  if (options.material >= std::max<std::size_t>(materials.size(), 1))
    throw Error(ErrorCode::usage, fmt::format("there is no material {}; add it first", options.material));
  if (options.prototype && options.mask != 0xffffffffu)
    throw Error(ErrorCode::usage, "a prototype has no mask; its instances have");
  geometry.name = options.name;
  geometry.mask = options.mask;
  geometry.material = options.material;
  geometry.prototype = options.prototype;
  return put(std::move(geometry));
}

GeometryId Scene::Impl::put(scene::AddedGeometry&& geometry) {
  const std::lock_guard lock(naming);
  geometries.emplace_back(std::move(geometry));
  note_other_geometries();
  return first_added + static_cast<GeometryId>(geometries.size() - 1);
}

const scene::AddedGeometry& Scene::Impl::prototype(GeometryId id) {
  const scene::AddedGeometry& geometry = added(id);
  if (geometry.is_instances())
    throw Error(ErrorCode::usage,
                fmt::format("geometry {} is instances itself, of which there are no instances", id));
  if (!geometry.prototype)
    throw Error(ErrorCode::usage,
                fmt::format("geometry {} is no prototype; add it as one to have instances of it", id));
  return geometry;
}

bool Scene::Impl::has_instances(GeometryId prototype) const {
  return std::ranges::any_of(geometries, [&](const auto& g) { return g && g->of == prototype; });
}

// Instances of what has no primitives are none.
bool Scene::Impl::is_seen(const scene::AddedGeometry& instances) const {
  const auto& prototype = geometries[instances.of - first_added];
  return instances.enabled && prototype->enabled && prototype->primitive_count() > 0;
}

query::GeometryTable Scene::Impl::table() const {
  query::GeometryTable table;
  if (file && file->enabled) {
    table.add(0, base.primitive_count(), file->mask);
    table.add_instances(0, static_cast<std::uint32_t>(base.instances.size()), file->mask);
  }
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    const auto& geometry = geometries[i];
    const GeometryId id = first_added + static_cast<GeometryId>(i);
    if (!geometry || geometry->prototype) continue;
    if (geometry->is_instances()) {
      if (is_seen(*geometry))
        table.add_instances(id, static_cast<std::uint32_t>(geometry->instances.size()), geometry->mask);
    } else if (geometry->enabled) {
      table.add(id, geometry->primitive_count(), geometry->mask);
    }
  }
  return table;
}

Scene Scene::load(const std::filesystem::path& file, const LoadOptions& options) {
  const Timer timer;
  Scene scene(scene::load(file, options));
  scene.impl_->load_seconds = timer.seconds();
  return scene;
}
Scene Scene::from_memory(std::string bytes, const std::filesystem::path& name, const LoadOptions& options) {
  const Timer timer;
  Scene scene(scene::load_from_memory(std::move(bytes), name, options));
  scene.impl_->load_seconds = timer.seconds();
  return scene;
}

Scene::Scene() : impl_(std::make_unique<Impl>()) {
  impl_->base.name = "the scene";
  impl_->note_change();  // a camera and lights are to be made up
}
Scene::Scene(scene::Scene&& model) : impl_(std::make_unique<Impl>()) {
  impl_->first_added = 1;
  impl_->file = {model.name, 0xffffffffu, model.primitive_count(),
                 true,       false,       static_cast<std::uint32_t>(model.instances.size())};
  impl_->base = std::move(model);
}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

GeometryId Scene::add_mesh(const Mesh& mesh, const GeometryOptions& options) {
  return impl_->add(scene::make_added(mesh), options);
}
GeometryId Scene::add_spheres(const Spheres& s, const GeometryOptions& options) {
  return add_shapes({"spheres", {{"centers", s.centers}, {"radii", s.radii}}}, options);
}
GeometryId Scene::add_cones(const Cones& c, const GeometryOptions& options) {
  Shapes cones{"cones", {{"bases", c.bases}, {"base_radii", c.base_radii}, {"apexes", c.apexes}}};
  if (!c.apex_radii.empty()) cones.fields.push_back({"apex_radii", c.apex_radii});
  return add_shapes(cones, options);
}
GeometryId Scene::add_discs(const Discs& d, const GeometryOptions& options) {
  return add_shapes({"discs", {{"centers", d.centers}, {"normals", d.normals}, {"radii", d.radii}}}, options);
}
GeometryId Scene::add_tori(const Tori& t, const GeometryOptions& options) {
  return add_shapes({"tori",
                     {{"centers", t.centers},
                      {"axes", t.axes},
                      {"major_radii", t.major_radii},
                      {"minor_radii", t.minor_radii}}},
                    options);
}
GeometryId Scene::add_shapes(const Shapes& shapes, const GeometryOptions& options) {
  return impl_->add(scene::make_added(shapes), options);
}

GeometryId Scene::add_instances(GeometryId prototype, const Transforms& transforms,
                                const InstanceOptions& options) {
  static_cast<void>(impl_->prototype(prototype));
  scene::AddedGeometry made = scene::make_added(prototype, transforms, options.materials,
                                                std::max<std::size_t>(impl_->materials.size(), 1));
  made.name = options.name;
  made.mask = options.mask;
  return impl_->put(std::move(made));
}
void Scene::update_transforms(GeometryId instances, const Transforms& transforms) {
  const std::lock_guard lock(impl_->naming);
  scene::move_instances(impl_->added(instances), transforms);
  impl_->note_change();
}

void Scene::update_vertices(GeometryId mesh, const Points& vertices, const Points& normals) {
  scene::AddedGeometry& geometry = impl_->added(mesh);
  scene::move_vertices(geometry, vertices, normals);
  impl_->note_change();
  impl_->changes.vertices = true;
  if (impl_->prototypes.erase(mesh) > 0) impl_->note_other_geometries();
}
void Scene::remove(GeometryId geometry) {
  const std::lock_guard lock(impl_->naming);
  if (impl_->is_file(geometry)) {
    impl_->file.reset();
  } else {
    if (impl_->added(geometry).prototype && impl_->has_instances(geometry))
      throw Error(ErrorCode::usage,
                  fmt::format("geometry {} is a prototype that has instances; remove these first", geometry));
    impl_->prototypes.erase(geometry);
    impl_->geometries[geometry - impl_->first_added].reset();
  }
  impl_->note_other_geometries();
}
void Scene::enable(GeometryId geometry, bool enabled) {
  (impl_->is_file(geometry) ? impl_->file->enabled : impl_->added(geometry).enabled) = enabled;
  impl_->note_other_geometries();
}
void Scene::set_mask(GeometryId geometry, std::uint32_t mask) {
  if (!impl_->is_file(geometry) && impl_->added(geometry).prototype && mask != 0xffffffffu)
    throw Error(ErrorCode::usage, "a prototype has no mask; its instances have");
  (impl_->is_file(geometry) ? impl_->file->mask : impl_->added(geometry).mask) = mask;
}

std::vector<GeometryId> Scene::geometries() const {
  std::vector<GeometryId> ids;
  if (impl_->file) ids.push_back(0);
  for (std::size_t i = 0; i < impl_->geometries.size(); ++i)
    if (impl_->geometries[i]) ids.push_back(impl_->first_added + static_cast<GeometryId>(i));
  return ids;
}
GeometryInfo Scene::info(GeometryId geometry) const {
  if (impl_->is_file(geometry)) return *impl_->file;
  const scene::AddedGeometry& added = impl_->added(geometry);
  const std::uint32_t primitives =
      added.is_instances() ? impl_->added(added.of).primitive_count() : added.primitive_count();
  return {added.name,    added.mask,      primitives,
          added.enabled, added.prototype, static_cast<std::uint32_t>(added.instances.size())};
}

namespace {

MeshArrays arrays_of(std::span<const dvec3> vertices, std::span<const scene::Triangle> triangles) {
  MeshArrays made;
  made.vertices.reserve(vertices.size());
  for (const dvec3& v : vertices) made.vertices.push_back({v.x, v.y, v.z});
  made.triangles.reserve(triangles.size());
  for (const scene::Triangle& t : triangles) made.triangles.push_back(t.vertex);
  return made;
}

}  // namespace

MeshArrays Scene::mesh(GeometryId geometry) const {
  if (impl_->is_file(geometry)) return arrays_of(impl_->base.vertices, impl_->base.triangles);
  const scene::AddedGeometry& added = impl_->added(geometry);
  return arrays_of(added.vertices, added.triangles);
}

std::vector<Part> Scene::Impl::parts_of(GeometryId id, std::vector<scene::NameRun> scene::Names::*runs) {
  std::vector<Part> parts;
  if (!is_file(id)) static_cast<void>(added(id));
  if (!is_file(id) || !base.names) return parts;
  const std::vector<scene::NameRun>& all = *base.names.*runs;
  for (std::size_t i = 0; i + 1 < all.size(); ++i)
    if (const std::string_view name = base.names->text(all[i].name); !name.empty())
      parts.push_back({std::string(name), all[i].first, all[i + 1].first - all[i].first});
  return parts;
}
std::vector<Part> Scene::parts(GeometryId geometry) const {
  return impl_->parts_of(geometry, &scene::Names::primitives);
}
std::vector<Part> Scene::instance_parts(GeometryId geometry) const {
  return impl_->parts_of(geometry, &scene::Names::instances);
}

std::vector<MaterialInfo> Scene::materials() const {
  const scene::Scene& file = impl_->base;
  const std::size_t n_file = file.materials.size();
  std::vector<MaterialInfo> all(
      n_file + std::max<std::size_t>(impl_->materials.size(), impl_->geometries.empty() ? 0 : 1));
  for (std::uint32_t i = 0; file.names && i < n_file; ++i) all[i].name = file.names->of_material(i);
  const auto count = [&all](const auto& primitives) {
    for (const auto& p : primitives) ++all.at(p.material).primitives;
  };
  if (impl_->file) primitives::for_each_kind([&](auto kind) { count(decltype(kind)::of(file)); });
  for (const auto& geometry : impl_->geometries)
    if (geometry && !geometry->is_instances())
      all.at(n_file + geometry->material).primitives += geometry->primitive_count();
  return all;
}

std::string Scene::name_of(GeometryId geometry, std::uint32_t primitive, std::uint32_t instance) const {
  if (geometry == kNoGeometry) return {};
  const std::shared_lock lock(impl_->naming);
  if (!impl_->is_file(geometry)) return impl_->added(geometry).name;
  std::string_view part;
  if (const auto& names = impl_->base.names)
    part = instance == kNoInstance ? names->of_primitive(primitive) : names->of_instance(instance);
  return part.empty() ? impl_->file->name : std::string(part);
}

std::uint32_t Scene::material_of(GeometryId geometry, std::uint32_t primitive, std::uint32_t instance) const {
  if (geometry == kNoGeometry) return kNoMaterial;
  const std::shared_lock lock(impl_->naming);
  if (impl_->is_file(geometry)) return impl_->base.material_of(primitive, instance);
  const auto n_file = static_cast<std::uint32_t>(impl_->base.materials.size());
  const scene::AddedGeometry& added = impl_->added(geometry);
  if (!added.is_instances()) return n_file + added.material;
  const std::uint32_t own =
      instance < added.instances.size() ? added.instances.data()[instance].material : scene::kNone;
  return n_file + (own != scene::kNone ? own : impl_->added(added.of).material);
}

MaterialId Scene::add_material(const Material& material) {
  impl_->materials.push_back(scene::textured_material(material, impl_->texturing));
  impl_->note_change();
  return static_cast<MaterialId>(impl_->materials.size() - 1);
}
PictureId Scene::add_picture(const std::filesystem::path& file) {
  impl_->texturing.pictures.push_back(scene::picture_of(file, impl_->base.warnings));
  return static_cast<PictureId>(impl_->texturing.pictures.size() - 1);
}
PictureId Scene::add_picture(const Pixels& pixels) {
  impl_->texturing.pictures.push_back(scene::picture_of(pixels));
  return static_cast<PictureId>(impl_->texturing.pictures.size() - 1);
}
void Scene::add_light(const Light& light) {
  const scene::Light made = scene::light_of(light);
  if (impl_->base.framing.lights) impl_->base.lights.clear();  // those that were made up
  impl_->base.framing.lights = false;
  impl_->base.lights.push_back(made);
  impl_->note_change();
}
void Scene::set_camera(const Camera& camera) {
  impl_->base.camera = scene::camera_of(camera);
  impl_->base.cameras = {*impl_->base.camera};
  impl_->base.framing.camera = false;
  impl_->note_change();
}
void Scene::set_background(const Color& color) {
  impl_->base.background = scene::color_of(color, "background");
  impl_->base.sky = {};
  impl_->note_change();
}
void Scene::set_background(const Gradient& gradient) {
  impl_->base.sky = scene::sky_of(gradient);
  impl_->note_change();
}
void Scene::set_background(const Environment& environment) {
  impl_->base.sky = scene::sky_of(environment, impl_->base.warnings);
  impl_->note_change();
}
void Scene::set_ambient(const Color& color) {
  impl_->base.ambient = scene::color_of(color, "ambient");
  impl_->note_change();
}

std::uint32_t Scene::primitives() const {
  return impl_->table().size();
}
std::optional<Extent> Scene::extent() const {
  const auto committed = impl_->last();
  const DBox box = bounds_of(committed->scene().prepared());
  if (box.empty()) return std::nullopt;
  return Extent{{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}};
}
std::vector<std::string> Scene::warnings() const {
  std::vector<std::string> all = impl_->base.warnings;
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->committed) return all;
  for (const std::string& warning : impl_->committed->scene().warnings())
    if (std::ranges::find(all, warning) == all.end()) all.push_back(warning);
  return all;
}
const scene::Scene& Scene::model() const {
  return impl_->model();
}
double Scene::load_seconds() const {
  return impl_->load_seconds;
}

CommitReport Scene::commit(const CommitOptions& options) {
  return impl_->commit(options);
}
PreparedScene Scene::prepared() const {
  return impl_->last()->scene();
}

Picture Scene::render(const RenderOptions& options, Look look) const {
  return impl_->asked()->render(options, look);
}
QueryReport Scene::closest(const Rays& rays, const HitsOut& out, const QueryOptions& options) const {
  const auto committed = impl_->asked();
  return query::closest(committed->query_context(), rays, out, options);
}
QueryReport Scene::any(const Rays& rays, const BytesOut& out, const QueryOptions& options) const {
  const auto committed = impl_->asked();
  return query::any(committed->query_context(), rays, out, options);
}

QueryReport Scene::count(const Rays& rays, const WordsOut& out, const QueryOptions& options) const {
  const auto committed = impl_->asked();
  return query::count(committed->query_context(), rays, out, options);
}
AllHits Scene::all(const Rays& rays, const AllHitsOptions& options) const {
  const auto committed = impl_->asked();
  return query::all(committed->query_context(), rays, options);
}

QueryReport Scene::closest_points(const Points& points, const ClosestPointsOut& out,
                                  const PointOptions& options) const {
  const auto committed = impl_->asked();
  return query::closest_points(committed->query_context(), points, out, options);
}
QueryReport Scene::inside(const Points& points, const BytesOut& out, const PointOptions& options) const {
  const auto committed = impl_->asked();
  return query::inside(committed->query_context(), points, out, options);
}
QueryReport Scene::signed_distance(const Points& points, const ValuesOut& out,
                                   const PointOptions& options) const {
  const auto committed = impl_->asked();
  return query::signed_distance(committed->query_context(), points, out, options);
}

}  // namespace kdray
