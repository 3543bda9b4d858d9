#include "scene/model/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "accel/prepare/instanced.h"
#include "accel/prepare/refit.h"
#include "api/committed.h"
#include "api/hooks.h"
#include "base/timer.h"
#include "engine/query/crossings.h"
#include "engine/query/points.h"
#include "kdray/kdray.h"
#include "scene/import/load.h"
#include "scene/model/added_geometry.h"
#include "scene/model/added_instances.h"
#include "scene/model/added_textures.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"

namespace kdray {

struct Scene::Impl {
  scene::Scene base;       // of the file; or nothing
  bool has_file = false;   // the base is geometry 0
  GeometryInfo file_info;  // of it
  bool file_removed = false;
  double load_seconds = 0;
  std::vector<std::optional<scene::AddedGeometry>> geometries;  // by id, after the file's; none: removed
  std::vector<scene::Material> materials;
  scene::Texturing texturing;  // of these materials
  bool changed = false;        // since `assembled` was made
  bool touched = false;        // since the last commit(), but for masks
  bool reshaped = false;       // since then: other geometries, not only other vertices or another look
  bool bent = false;           // since then: other vertices, not only other transforms or another look
  bool replaced = false;       // by the last commit(): instances alone were elsewhere

  // Of prototypes, by their ids, the meshes that their instances are of: as they are in `assembled`.
  struct Prototype {
    std::uint32_t first_material;
    std::shared_ptr<const scene::Scene> mesh;
  };
  std::map<GeometryId, Prototype> prototypes;

  mutable std::optional<scene::Scene> assembled;  // base and geometries together, where there are some

  std::unique_ptr<const prepare::Fitting> fitting;  // of the tree as it was built, once it was refitted
  double growth = 1;  // of what a ray is expected to cost, from then to what is committed

  std::mutex mutex;  // of `committed`
  std::shared_ptr<api::Committed> committed;

  GeometryId first_added() const { return has_file ? 1 : 0; }
  bool is_file(GeometryId id) const { return has_file && id == 0 && !file_removed; }
  scene::AddedGeometry& added(GeometryId id);
  GeometryId add(scene::AddedGeometry&& geometry, const GeometryOptions& options);
  GeometryId put(scene::AddedGeometry&& geometry);
  const scene::AddedGeometry& prototype(GeometryId id);
  bool has_instances(GeometryId prototype) const;
  bool is_seen(const scene::AddedGeometry& instances) const;
  const std::shared_ptr<const scene::Scene>& mesh_of(GeometryId prototype, std::uint32_t first_material);
  void put_instances(scene::Scene& all, std::uint32_t first_material);
  const scene::Scene& model();
  void touch();
  void reshape();
  std::optional<PreparedScene> replace_instances(CommitReport& report);
  std::optional<PreparedScene> refit(const CommitOptions& options, CommitReport& report);
  PreparedScene build(const CommitOptions& options);
  void settle(const CommitReport& report);
  query::GeometryTable table() const;
  std::shared_ptr<api::Committed> last();   // that was committed
  std::shared_ptr<api::Committed> asked();  // of the device, too
};

namespace {

[[noreturn]] void no_such(GeometryId id) {
  throw Error(ErrorCode::usage, fmt::format("there is no geometry {}", id));
}

scene::Scene only_settings(const scene::Scene& scene) {
  scene::Scene settings;
  settings.name = scene.name;
  settings.lights = scene.lights;
  settings.unlit = scene.unlit;
  settings.camera = scene.camera;
  settings.framing = scene.framing;
  settings.cameras = scene.cameras;
  settings.background = scene.background;
  settings.sky = scene.sky;
  settings.ambient = scene.ambient;
  settings.settings = scene.settings;
  settings.warnings = scene.warnings;
  settings.load_options = scene.load_options;
  return settings;
}

}  // namespace

scene::AddedGeometry& Scene::Impl::added(GeometryId id) {
  if (id < first_added() && file_removed) no_such(id);
  if (id < first_added()) throw Error(ErrorCode::usage, "geometry 0 is the file's: it can't be changed");
  const std::size_t i = id - first_added();
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
  geometries.emplace_back(std::move(geometry));
  reshape();
  return first_added() + static_cast<GeometryId>(geometries.size() - 1);
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
  const auto& prototype = geometries[instances.of - first_added()];
  return instances.enabled && prototype->enabled && prototype->primitive_count() > 0;
}

const std::shared_ptr<const scene::Scene>& Scene::Impl::mesh_of(GeometryId prototype,
                                                                std::uint32_t first_material) {
  Prototype& known = prototypes[prototype];
  if (!known.mesh || known.first_material != first_material)
    known = {first_material,
             std::make_shared<const scene::Scene>(scene::mesh_of(added(prototype), first_material))};
  return known.mesh;
}

void Scene::Impl::put_instances(scene::Scene& all, std::uint32_t first_material) {
  std::map<GeometryId, std::uint32_t> meshes;  // of `all`, by prototypes
  for (const auto& geometry : geometries) {
    if (!geometry || !geometry->is_instances() || !is_seen(*geometry)) continue;
    const auto [at, is_new] = meshes.try_emplace(geometry->of, static_cast<std::uint32_t>(all.meshes.size()));
    if (is_new) all.meshes.push_back(mesh_of(geometry->of, first_material));
    scene::put_instances(all, *geometry, at->second, first_material);
  }
  if (all.materials.size() == first_material && !all.meshes.empty())
    all.materials.push_back(scene::material_of({}));
}

void Scene::Impl::touch() {
  changed = touched = true;
}
void Scene::Impl::reshape() {
  touch();
  reshaped = true;
}

const scene::Scene& Scene::Impl::model() {
  if (!changed) return assembled ? *assembled : base;
  const bool with_file = has_file && !file_removed && file_info.enabled;
  std::vector<const scene::AddedGeometry*> enabled;
  for (const auto& geometry : geometries)
    if (geometry && geometry->enabled && !geometry->prototype && !geometry->is_instances())
      enabled.push_back(&*geometry);
  const bool moved = assembled && !reshaped;  // since then
  scene::Scene all = with_file && !moved ? base : only_settings(base);
  if (with_file && moved) {
    all.materials = base.materials;
    all.texturing = base.texturing;
    all.meshes = base.meshes;
    all.instances = base.instances;
  }
  const auto first_material = static_cast<std::uint32_t>(all.materials.size());
  if (moved) {
    scene::Scene before = std::move(*assembled);
    assembled.reset();
    scene::assemble_moved(all, std::move(before), enabled, materials);
  } else {
    scene::assemble(all, enabled, materials);
  }
  scene::assemble_textures(all, enabled, texturing, materials.size());
  put_instances(all, first_material);
  // It is the file's no more, and is not to be kept as the file's (host/accel/cache). What was made up for
  // the file alone is made up anew.
  all.files.clear();
  if (all.framing.camera) all.camera.reset();
  if (all.framing.lights) all.lights.clear();
  all.framing = {};
  scene::frame_scene(all);
  assembled = std::move(all);
  changed = false;
  return *assembled;
}

query::GeometryTable Scene::Impl::table() const {
  query::GeometryTable table;
  if (has_file && !file_removed && file_info.enabled) {
    table.add(0, base.primitive_count(), file_info.mask);
    table.add_instances(0, static_cast<std::uint32_t>(base.instances.size()), file_info.mask);
  }
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    const auto& geometry = geometries[i];
    const GeometryId id = first_added() + static_cast<GeometryId>(i);
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

std::shared_ptr<api::Committed> Scene::Impl::last() {
  const std::lock_guard lock(mutex);
  if (!committed)
    throw Error(ErrorCode::usage, "the scene has to be committed before anything is asked of it");
  return committed;
}
std::shared_ptr<api::Committed> Scene::Impl::asked() {
  device::refuse_after_fork();
  return last();
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
  impl_->touch();  // a camera and lights are to be made up
}
Scene::Scene(scene::Scene&& model) : impl_(std::make_unique<Impl>()) {
  impl_->has_file = true;
  impl_->file_info = {model.name, 0xffffffffu, model.primitive_count(),
                      true,       false,       static_cast<std::uint32_t>(model.instances.size())};
  impl_->base = std::move(model);
}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

GeometryId Scene::add_mesh(const Mesh& mesh, const GeometryOptions& options) {
  return impl_->add(scene::make_added(mesh), options);
}
GeometryId Scene::add_spheres(const Spheres& spheres, const GeometryOptions& options) {
  return impl_->add(scene::make_added(spheres), options);
}
GeometryId Scene::add_cones(const Cones& cones, const GeometryOptions& options) {
  return impl_->add(scene::make_added(cones), options);
}
GeometryId Scene::add_discs(const Discs& discs, const GeometryOptions& options) {
  return impl_->add(scene::make_added(discs), options);
}
GeometryId Scene::add_tori(const Tori& tori, const GeometryOptions& options) {
  return impl_->add(scene::make_added(tori), options);
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
  scene::move_instances(impl_->added(instances), transforms);
  impl_->touch();
}

void Scene::update_vertices(GeometryId mesh, const Points& vertices, const Points& normals) {
  scene::AddedGeometry& geometry = impl_->added(mesh);
  scene::move_vertices(geometry, vertices, normals);
  impl_->touch();
  impl_->bent = true;
  if (impl_->prototypes.erase(mesh) > 0) impl_->reshape();
}
void Scene::remove(GeometryId geometry) {
  if (impl_->is_file(geometry)) {
    impl_->file_removed = true;
  } else {
    if (impl_->added(geometry).prototype && impl_->has_instances(geometry))
      throw Error(ErrorCode::usage,
                  fmt::format("geometry {} is a prototype that has instances; remove these first", geometry));
    impl_->prototypes.erase(geometry);
    impl_->geometries[geometry - impl_->first_added()].reset();
  }
  impl_->reshape();
}
void Scene::enable(GeometryId geometry, bool enabled) {
  (impl_->is_file(geometry) ? impl_->file_info.enabled : impl_->added(geometry).enabled) = enabled;
  impl_->reshape();
}
void Scene::set_mask(GeometryId geometry, std::uint32_t mask) {
  if (!impl_->is_file(geometry) && impl_->added(geometry).prototype && mask != 0xffffffffu)
    throw Error(ErrorCode::usage, "a prototype has no mask; its instances have");
  (impl_->is_file(geometry) ? impl_->file_info.mask : impl_->added(geometry).mask) = mask;
}

std::vector<GeometryId> Scene::geometries() const {
  std::vector<GeometryId> ids;
  if (impl_->has_file && !impl_->file_removed) ids.push_back(0);
  for (std::size_t i = 0; i < impl_->geometries.size(); ++i)
    if (impl_->geometries[i]) ids.push_back(impl_->first_added() + static_cast<GeometryId>(i));
  return ids;
}
GeometryInfo Scene::info(GeometryId geometry) const {
  if (impl_->is_file(geometry)) return impl_->file_info;
  const scene::AddedGeometry& added = impl_->added(geometry);
  const std::uint32_t primitives =
      added.is_instances() ? impl_->added(added.of).primitive_count() : added.primitive_count();
  return {added.name,    added.mask,      primitives,
          added.enabled, added.prototype, static_cast<std::uint32_t>(added.instances.size())};
}

MaterialId Scene::add_material(const Material& material) {
  impl_->materials.push_back(scene::textured_material(material, impl_->texturing));
  impl_->touch();
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
  impl_->touch();
}
void Scene::set_camera(const Camera& camera) {
  impl_->base.camera = scene::camera_of(camera);
  impl_->base.cameras = {*impl_->base.camera};
  impl_->base.framing.camera = false;
  impl_->touch();
}
void Scene::set_background(const Color& color) {
  impl_->base.background = scene::color_of(color, "background");
  impl_->base.sky = {};
  impl_->touch();
}
void Scene::set_background(const Gradient& gradient) {
  impl_->base.sky = scene::sky_of(gradient);
  impl_->touch();
}
void Scene::set_background(const Environment& environment) {
  impl_->base.sky = scene::sky_of(environment, impl_->base.warnings);
  impl_->touch();
}
void Scene::set_ambient(const Color& color) {
  impl_->base.ambient = scene::color_of(color, "ambient");
  impl_->touch();
}

std::uint32_t Scene::primitives() const {
  return impl_->table().size();
}
std::optional<Extent> Scene::extent() const {
  const auto committed = impl_->last();
  const auto& geometry = committed->scene().prepared().geometry;
  if (geometry.bounds.empty()) return std::nullopt;
  const dvec3 lo = geometry.space.world(dvec3(geometry.bounds.lo)),
              hi = geometry.space.world(dvec3(geometry.bounds.hi));
  return Extent{{lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z}};
}
const std::vector<std::string>& Scene::warnings() const {
  return impl_->base.warnings;
}
const scene::Scene& Scene::model() const {
  return impl_->model();
}
double Scene::load_seconds() const {
  return impl_->load_seconds;
}

// What was committed with instances where they are now. Nothing where that isn't all that has changed.
std::optional<PreparedScene> Scene::Impl::replace_instances(CommitReport& report) {
  if (bent) return std::nullopt;
  std::optional<prepare::Prepared> made = prepare::replace_instances(model(), committed->scene().prepared());
  if (!made) return std::nullopt;
  report.refitted = true;
  return PreparedScene(std::move(*made));
}

// The tree of the last commit, fitted to where vertices are now. Nothing where it can't be, or isn't to be.
std::optional<PreparedScene> Scene::Impl::refit(const CommitOptions& options, CommitReport& report) {
  if (!committed || reshaped || !(options.refit_growth > 0)) return std::nullopt;
  const prepare::Prepared& last = committed->scene().prepared();
  const bool has_instances = !last.flat.instances.empty();
  // The binary form has planes, which don't move (nor is there one of instances); and a limit on memory asks
  // for trees of several kinds.
  if (!(last.tree_options == options.tree) || (options.tree.binary_form && !has_instances) ||
      options.tree.memory_bytes > 0)
    return std::nullopt;
  if (!touched && growth <= options.refit_growth) {
    report = {true, growth};
    return committed->scene();
  }
  if (has_instances) return replace_instances(report);
  if (!fitting) fitting = std::make_unique<const prepare::Fitting>(last);
  prepare::Refitted made = prepare::refit(model(), last, *fitting, options.refit_growth);
  report.growth = made.growth;
  report.refitted = made.scene.has_value();
  if (!made.scene) return std::nullopt;
  return PreparedScene(std::move(*made.scene));
}

PreparedScene Scene::Impl::build(const CommitOptions& options) {
  std::optional<LocalSpace> kept;
  if (committed && !reshaped) kept = committed->scene().prepared().geometry.space;
  prepare::Prepared made = prepare::prepare(model(), options.tree, kept);
  made.seconds.load = load_seconds;
  return PreparedScene(std::move(made));
}

// Ends a commit. All arrays are held twice only where vertices go on moving.
void Scene::Impl::settle(const CommitReport& report) {
  const bool has_moved = report.refitted && touched;
  if (has_moved) replaced = !fitting;
  if (!report.refitted) replaced = false;
  if (assembled && !fitting && !replaced) {
    assembled.reset();
    changed = true;
  }
  touched = reshaped = bent = false;
  growth = report.refitted ? report.growth : 1;
  if (!report.refitted) fitting.reset();
}

CommitReport Scene::commit(const CommitOptions& options) {
  api::open_device(options.device, {});  // without a device there is no use in building a tree
  CommitReport report;
  std::optional<PreparedScene> ready = impl_->refit(options, report);
  if (!ready) ready = impl_->build(options);
  const std::shared_ptr<api::Committed> committed(new api::Committed(*ready, impl_->table(), options.device),
                                                  [](api::Committed* made) {
                                                    if (!device::is_forked_off())
                                                      delete made;  // it holds OpenCL's objects
                                                  });
  impl_->settle(report);
  const std::lock_guard lock(impl_->mutex);
  impl_->committed = committed;
  return report;
}
PreparedScene Scene::prepared() const {
  return impl_->last()->scene();
}

Picture Scene::render(const RenderOptions& options) const {
  return impl_->asked()->render(options);
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
