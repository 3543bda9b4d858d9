#include "apps/view/scene_renderer.h"

#include <sys/stat.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numbers>
#include <span>
#include <utility>

#include "base/error.h"
#include "io/image/channels.h"
#include "io/image/color.h"
#include "io/image/picture_file.h"
#include "io/image/png.h"
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
    : loaded_(std::move(loaded)), settings_(settings) {
  studio_.scene = loaded_.studio;
}

const PreparedScene& SceneRenderer::scene(const ShownLook& shown) const {
  if (shown.look == kdray::Look::plain) return loaded_.scene;
  Studio& studio = shown.instead == settings_.studio_instead ? studio_ : instead_;
  std::call_once(studio.made, [&] {
    if (!studio.scene) studio.scene = loaded_.scene.in_studio(shown.instead);
  });
  return *studio.scene;
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

namespace {

struct JpegOptions {
  int quality = 80;
  bool full_color = false;  // each pixel has its own colour (4:4:4), or four share one (4:2:0)
};

constexpr int kTable = 16384;

const std::array<unsigned char, kTable + 1>& display_table() {
  static const auto table = [] {
    std::array<unsigned char, kTable + 1> codes{};
    for (int i = 0; i <= kTable; ++i)
      codes[static_cast<std::size_t>(i)] = static_cast<unsigned char>(
          255 * image::encode(image::Transfer{}, static_cast<double>(i) / kTable) + 0.5);
    return codes;
  }();
  return table;
}

struct Free {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

std::string compress(const std::vector<unsigned char>& bytes, int width, int height, bool grey,
                     const JpegOptions& options) {
  const std::unique_ptr<void, int (*)(tjhandle)> jpeg(tjInitCompress(), tjDestroy);
  if (!jpeg) throw Error(ErrorCode::internal, "libjpeg-turbo can't be started");
  unsigned char* out = nullptr;
  unsigned long n = 0;
  const int colors = grey ? TJSAMP_GRAY : options.full_color ? TJSAMP_444 : TJSAMP_420;
  const int status =
      tjCompress2(jpeg.get(), bytes.data(), width, 0, height, grey ? TJPF_GRAY : TJPF_RGB, &out, &n, colors,
                  options.quality, TJFLAG_FASTDCT * (options.full_color ? 0 : 1));
  const std::unique_ptr<unsigned char, Free> owned(out);
  if (status != 0) throw Error(ErrorCode::internal, std::string("JPEG: ") + tjGetErrorStr2(jpeg.get()));
  return {reinterpret_cast<const char*>(out), n};
}

// Through sRGB's curve, by a table: within half a code of what a PNG has.
std::string encode_jpeg(const Picture& picture, const JpegOptions& options) {
  const auto& table = display_table();
  std::vector<unsigned char> bytes(picture.rgb.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    // Of NaN this makes 0, as in a PNG.
    const float value = std::min(std::max(0.0f, picture.rgb[i]), 1.0f);
    bytes[i] = table[static_cast<std::size_t>(value * kTable + 0.5f)];
  }
  return compress(bytes, picture.width, picture.height, false, options);
}

std::string encode_jpeg(const image::PngPixels& pixels, const JpegOptions& options) {
  std::vector<unsigned char> bytes(pixels.samples.size());
  const int shift = pixels.bits == 16 ? 8 : 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<unsigned char>(pixels.samples[i] >> shift);
  return compress(bytes, pixels.width, pixels.height, pixels.channels == 1, options);
}

std::vector<vec3> pixels_of(const Picture& picture) {
  std::vector<vec3> pixels(picture.rgb.size() / 3);
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  std::memcpy(pixels.data(), picture.rgb.data(), pixels.size() * sizeof(vec3));
  return pixels;
}

image::ChannelPicture channel_of(const Picture& picture) {
  std::vector<image::Channel> channels;
  for (const Channel& c : picture.channels) channels.push_back({c.name, c.values});
  const std::vector<image::ChannelPicture> pictures =
      image::channel_pictures(picture.width, picture.height, channels, pixels_of(picture));
  if (pictures.empty()) throw Error(ErrorCode::internal, "the channel was not rendered");
  return pictures.front();
}

}  // namespace

std::string as_jpeg(const Picture& picture, const RenderOptions& options, bool at_rest) {
  const JpegOptions jpeg = at_rest ? JpegOptions{92, true} : JpegOptions{78, false};
  if (options.channels.empty()) return encode_jpeg(picture, jpeg);
  return encode_jpeg(channel_of(picture).pixels, jpeg);
}

std::string as_png(const Picture& picture, const RenderOptions& options) {
  if (!options.channels.empty()) {
    const image::ChannelPicture channel = channel_of(picture);
    return image::encode_png(channel.pixels, channel.meta);
  }
  const image::Image image{picture.width, picture.height, pixels_of(picture)};
  return image::encode_picture(image::PictureFormat::png, image, {}, {});
}

}  // namespace kdray::view
