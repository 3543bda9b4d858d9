#include "apps/view/scene_renderer.h"

#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>
#include <utility>

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
    : loaded_(std::move(loaded)), settings_(settings), studio_(loaded_.studio) {}

const PreparedScene& SceneRenderer::scene(kdray::Look look) const {
  if (look == kdray::Look::plain) return loaded_.scene;
  std::call_once(studio_made_, [this] {
    if (!studio_) studio_ = loaded_.scene.in_studio();
  });
  return *studio_;
}

std::vector<std::filesystem::path> SceneRenderer::files() const {
  std::vector<std::filesystem::path> paths;
  for (const scene::FileRead& file : loaded_.scene.settings().files)
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
  renderer_.emplace(loaded_.scene, device);
  if (queues == 1) {
    Tuning tuning = renderer_->statistics().tuning.settings;
    tuning.waves = tuning.waves > 0 ? std::min(tuning.waves, kWavesOfLaunch) : kWavesOfLaunch;
    renderer_->tune(tuning);
  }
  queues_ = queues;
}

Picture SceneRenderer::render(const ViewRequest& request, const RenderOptions& options) {
  make_ready(request);
  const PreparedScene& shown = scene(look_of(request, settings_));
  renderer_->look(shown.seen(view_of(request, settings_), request.width, request.height));
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

namespace {

struct Cell {
  std::uint32_t node = 0;
  Box box;
};

bool is_leaf(const layout::KdNode& node) {
  return (node.word1 & 3) == KDRAY_NODE_LEAF;
}

// Splits the cell. A plane that doesn't part its box leaves it to one of the two.
void split(const Cell& cell, const layout::KdNode& node, std::vector<Cell>& below) {
  const int axis = static_cast<int>(node.word1 & 3);
  const auto plane = std::bit_cast<float>(node.word0);
  Cell low{cell.node + 1, cell.box}, high{node.word1 >> 2, cell.box};
  low.box.hi[axis] = std::min(plane, cell.box.hi[axis]);
  high.box.lo[axis] = std::max(plane, cell.box.lo[axis]);
  for (const Cell& child : {low, high})
    if (!child.box.empty()) below.push_back(child);
}

}  // namespace

std::vector<DBox> cells_of(const prepare::Prepared& scene, int depth) {
  const auto& nodes = scene.flat.nodes;
  if (nodes.size() == 0 || scene.geometry.bounds.empty()) return {};
  std::vector<Cell> level{{0, scene.geometry.bounds}};
  for (int d = 0; d < depth; ++d) {
    std::vector<Cell> below;
    for (const Cell& cell : level) {
      const layout::KdNode& node = nodes.data()[cell.node];
      is_leaf(node) ? below.push_back(cell) : split(cell, node, below);
    }
    if (below.size() > kMostCells) break;
    level = std::move(below);
  }
  std::vector<DBox> boxes;
  const LocalSpace& space = scene.geometry.space;
  for (const Cell& cell : level)
    boxes.push_back({space.world(dvec3(cell.box.lo)), space.world(dvec3(cell.box.hi))});
  return boxes;
}

FileWatcher::FileWatcher(std::vector<std::filesystem::path> files)
    : files_(std::move(files)), known_(state()), last_(known_) {}

std::string FileWatcher::state() const {
  std::string seen;
  for (const std::filesystem::path& file : files_) {
    struct stat info {};
    const bool there = ::stat(file.c_str(), &info) == 0;
    if (there)
      seen += std::to_string(info.st_ino) + " " + std::to_string(info.st_size) + " " +
              std::to_string(info.st_mtim.tv_sec) + "." + std::to_string(info.st_mtim.tv_nsec);
    seen += "\n";
  }
  return seen;
}

bool FileWatcher::changed() {
  std::string now = state();
  const bool settled = now == last_;
  last_ = std::move(now);
  if (!settled || last_ == known_) return false;
  known_ = last_;
  return true;
}

}  // namespace kdray::view
