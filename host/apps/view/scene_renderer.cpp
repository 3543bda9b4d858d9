#include "apps/view/scene_renderer.h"

#include <algorithm>
#include <numbers>

#include "accel/prepare/prepared.h"
#include "scene/model/scene.h"

namespace kdray::view {

namespace {

// A picture is cancelled between launches, two of which are under way. With the usual 64 waves each of them
// takes up to a quarter of a second on two cores, which the first move after a rest would have to wait for;
// with so many a tenth of that, and pictures take as long as before (docs/logbook/view.md). Several queues
// have short ones anyway.
constexpr int kWavesOfLaunch = 8;

Vec3 triple_of(const dvec3& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

SceneRenderer::SceneRenderer(LoadedScene loaded, const Settings& settings)
    : loaded_(std::move(loaded)), settings_(settings) {}

std::vector<std::filesystem::path> SceneRenderer::files() const {
  std::vector<std::filesystem::path> paths;
  for (const scene::FileRead& file : scene().settings().files)
    if (!file.only_named) paths.push_back(file.path);
  return paths;
}

Camera SceneRenderer::camera(int width, int height) const {
  const PreparedScene seen = scene().seen(settings_.view, width, height);
  const scene::Camera camera = seen.settings().camera.value_or(scene::Camera{});
  return {.from = triple_of(camera.from),
          .at = triple_of(camera.at),
          .up = triple_of(camera.up),
          .fov = camera.vertical_fov * 180 / std::numbers::pi,
          .ortho_width = camera.ortho_width};
}

void SceneRenderer::make_ready(const ViewRequest& request) {
  const int queues = queues_of(request, settings_);
  if (renderer_ && queues == queues_) return;
  DeviceOptions device = settings_.device;
  device.queues = queues;
  renderer_.emplace(scene(), device);
  if (queues == 1) {
    Tuning tuning = renderer_->statistics().tuning.settings;
    tuning.waves = tuning.waves > 0 ? std::min(tuning.waves, kWavesOfLaunch) : kWavesOfLaunch;
    renderer_->tune(tuning);
  }
  queues_ = queues;
}

Picture SceneRenderer::render(const ViewRequest& request, const RenderOptions& options) {
  make_ready(request);
  renderer_->look(scene().seen(view_of(request, settings_), request.width, request.height));
  return renderer_->render(options);
}

std::optional<Picked> SceneRenderer::pick(const ViewRequest& request, double x, double y) {
  if (!picker_) {
    std::vector<GeometryName> geometries = loaded_.geometries;
    if (geometries.empty())
      geometries = {{"", 0, static_cast<std::uint32_t>(scene().prepared().counts.primitives)}};
    picker_.emplace(scene(), std::move(geometries), settings_.device);
  }
  return picker_->pick(eye_ray(request.camera, static_cast<double>(request.width) / request.height, x, y));
}

}  // namespace kdray::view
