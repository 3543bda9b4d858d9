#include "api/scene_impl.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "accel/prepare/instanced.h"
#include "api/hooks.h"
#include "base/error.h"
#include "device/opencl/platform.h"
#include "scene/model/added_geometry.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"

namespace kdray {

namespace {

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

void Scene::Impl::note_change() {
  is_stale = changes.any = true;
}
void Scene::Impl::note_other_geometries() {
  note_change();
  changes.geometries = true;
}

// What is there before any geometry is added: all of the file, or what of it doesn't move.
scene::Scene Scene::Impl::begin_model(bool has_moved) const {
  const bool with_file = file && file->enabled;
  if (with_file && !has_moved) return base;
  scene::Scene all = only_settings(base);
  if (with_file) {
    all.materials = base.materials;
    all.texturing = base.texturing;
    all.meshes = base.meshes;
    all.instances = base.instances;
    all.names = base.names;
  }
  return all;
}

const scene::Scene& Scene::Impl::model() {
  if (!is_stale) return assembled ? *assembled : base;
  std::vector<const scene::AddedGeometry*> enabled;
  for (const auto& geometry : geometries)
    if (geometry && geometry->enabled && !geometry->prototype && !geometry->is_instances())
      enabled.push_back(&*geometry);
  const bool has_moved = assembled && !changes.geometries;  // since then
  scene::Scene all = begin_model(has_moved);
  const auto first_material = static_cast<std::uint32_t>(all.materials.size());
  if (has_moved) {
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
  const bool is_file =
      file && file->enabled && std::ranges::none_of(geometries, [](const auto& g) { return g.has_value(); });
  all.framing = {.box = is_file ? base.framing.box : DBox{}};
  scene::frame_scene(all);
  assembled = std::move(all);
  is_stale = false;
  return *assembled;
}

// What was committed with instances where they are now. Nothing where that isn't all that has changed.
std::optional<PreparedScene> Scene::Impl::replace_instances(CommitReport& report) {
  if (changes.vertices) return std::nullopt;
  std::optional<prepare::Prepared> made = prepare::replace_instances(model(), committed->scene().prepared());
  if (!made) return std::nullopt;
  report.refitted = true;
  return PreparedScene(std::move(*made));
}

// The tree of the last commit, fitted to where vertices are now. Nothing where it can't be, or isn't to be.
std::optional<PreparedScene> Scene::Impl::refit(const CommitOptions& options, CommitReport& report) {
  if (!committed || changes.geometries || !(options.refit_growth > 0)) return std::nullopt;
  const prepare::Prepared& last = committed->scene().prepared();
  const bool has_instances = !last.flat.instances.empty();
  // The binary form has planes, which don't move (nor is there one of instances); and a limit on memory asks
  // for trees of several kinds.
  if (!(last.tree_options == options.tree) || (*options.tree.binary_form && !has_instances) ||
      options.tree.memory_bytes > 0)
    return std::nullopt;
  if (!changes.any && growth <= options.refit_growth) {
    report = {true, growth};
    return committed->scene();
  }
  // Doubles have a space that is exact for the vertices that it was made for.
  if (last.doubles) return std::nullopt;
  if (changes.vertices && prepare::answers_in_doubles(model(), options.tree.geometry, last.geometry.space))
    return std::nullopt;
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
  if (committed && !changes.geometries) kept = committed->scene().prepared().geometry.space;
  prepare::Prepared made = prepare::prepare(model(), options.tree, kept);
  made.seconds.load = load_seconds;
  return PreparedScene(std::move(made));
}

// Ends a commit. All arrays are held twice only where vertices go on moving.
void Scene::Impl::settle(const CommitReport& report) {
  const bool has_moved = report.refitted && changes.any;
  if (has_moved) has_replaced = !fitting;
  if (!report.refitted) has_replaced = false;
  if (assembled && !fitting && !has_replaced) {
    assembled.reset();
    is_stale = true;
  }
  changes = {};
  growth = report.refitted ? report.growth : 1;
  if (!report.refitted) fitting.reset();
}

CommitReport Scene::Impl::commit(CommitOptions options) {
  if (!options.tree.binary_form) options.tree.binary_form = false;
  if (!options.device.remember_programs) options.device.remember_programs = true;
  if (std::isnan(options.refit_growth)) throw Error(ErrorCode::usage, "refit_growth is not a number");
  api::open_device(options.device, {});  // without a device there is no use in building a tree
  CommitReport report;
  std::optional<PreparedScene> ready = refit(options, report);
  if (!ready) ready = build(options);
  report.geometry = ready->prepared().doubles ? VertexPrecision::float64 : VertexPrecision::float32;
  const std::shared_ptr<api::Committed> made(new api::Committed(*ready, table(), options.device),
                                             [](api::Committed* made) {
                                               if (!device::is_forked_off())
                                                 delete made;  // it holds OpenCL's objects
                                             });
  settle(report);
  const std::lock_guard lock(mutex);
  committed = made;
  return report;
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

}  // namespace kdray
