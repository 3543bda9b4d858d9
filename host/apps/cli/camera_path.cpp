#include "apps/cli/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "scene/import/files.h"
#include "scene/import/json/json_node.h"
#include "scene/model/check_scene.h"

namespace kdray::cli {

namespace {

constexpr std::string_view kFileKeys[] = {"kdray_camera_path", "interpolation", "keys"};
constexpr std::string_view kCameraKeys[] = {"frame", "from", "at", "up", "fov"};
constexpr int kMostFrame = 999999;

// Returns why no picture can be made by this camera; null: one can.
const char* fault_in(const Camera& c) {
  scene::Camera camera;
  camera.from = {c.from[0], c.from[1], c.from[2]};
  camera.at = {c.at[0], c.at[1], c.at[2]};
  camera.up = {c.up[0], c.up[1], c.up[2]};
  camera.vertical_fov = c.fov * (3.14159265358979323846 / 180);
  return scene::fault_of(camera);
}

Camera camera_of_key(const scene::JsonNode& node) {
  node.expect_keys({"key", kCameraKeys});
  const auto vector = [](const scene::JsonNode& value) {
    const dvec3 v = value.vector();
    return Vec3{v.x, v.y, v.z};
  };
  Camera camera;
  camera.from = vector(node["from"]);
  camera.at = vector(node["at"]);
  if (const auto up = node.find("up")) camera.up = vector(*up);
  if (const auto fov = node.find("fov")) camera.fov = fov->number_between(1e-3, 179.9);
  if (const char* const fault = fault_in(camera)) throw node.error(fault);
  return camera;
}

}  // namespace

CameraPath::CameraPath(const std::filesystem::path& file) : file_(file.string()) {
  const nlohmann::json document = scene::parse_json(scene::read_file(file), file_);
  const scene::JsonNode root(document, file_);
  root.expect_keys({"camera path", kFileKeys});
  (void)root["kdray_camera_path"].integer(1, 1);
  if (const auto interpolation = root.find("interpolation")) {
    const std::string kind = interpolation->string();
    if (kind != "smooth" && kind != "linear") throw interpolation->expected("smooth or linear");
    smooth_ = kind == "smooth";
  }
  for (const scene::JsonNode& node : root["keys"].elements()) {
    const Camera c = camera_of_key(node);
    const double frame = node["frame"].integer(0, kMostFrame);
    if (!keys_.empty() && frame <= keys_.back().frame)
      throw node.error("the frame is not behind that of the key before");
    keys_.push_back(
        {frame,
         {c.from[0], c.from[1], c.from[2], c.at[0], c.at[1], c.at[2], c.up[0], c.up[1], c.up[2], c.fov}});
  }
  if (keys_.empty()) throw root["keys"].expected("one key at least");
}

// Returns by how much a value changes from frame to frame where the curve passes a key: the mean of both
// sides, where the shorter side weighs more (a parabola through three keys has that slope).
double CameraPath::slope(std::size_t key, std::size_t value) const {
  const auto of_side = [&](std::size_t i) {
    return (keys_[i + 1].values[value] - keys_[i].values[value]) / (keys_[i + 1].frame - keys_[i].frame);
  };
  if (key == 0) return of_side(0);
  if (key + 1 == keys_.size()) return of_side(key - 1);
  const double before = keys_[key].frame - keys_[key - 1].frame,
               after = keys_[key + 1].frame - keys_[key].frame;
  return (of_side(key - 1) * after + of_side(key) * before) / (before + after);
}

Camera CameraPath::at(int frame) const {
  const auto above = std::upper_bound(keys_.begin(), keys_.end(), static_cast<double>(frame),
                                      [](double f, const Key& key) { return f < key.frame; });
  Values v;
  if (above == keys_.begin()) {
    v = keys_.front().values;
  } else if (above == keys_.end()) {
    v = keys_.back().values;
  } else {
    const auto i = static_cast<std::size_t>(above - keys_.begin()) - 1;
    const Key &a = keys_[i], &b = keys_[i + 1];
    const double length = b.frame - a.frame, t = (frame - a.frame) / length;
    for (std::size_t k = 0; k < kValues; ++k) {
      const double step = b.values[k] - a.values[k];
      if (!smooth_) {
        v[k] = a.values[k] + t * step;
        continue;
      }
      const double in = slope(i, k) * length, out = slope(i + 1, k) * length;  // Hermite's cubic
      v[k] = a.values[k] + t * (in + t * ((3 * step - 2 * in - out) + t * (in + out - 2 * step)));
    }
  }
  const Camera camera{
      .from = {v[0], v[1], v[2]}, .at = {v[3], v[4], v[5]}, .up = {v[6], v[7], v[8]}, .fov = v[9]};
  if (const char* const fault = fault_in(camera))
    throw input_error(file_, 0, fmt::format("between its keys, at frame {}: {}", frame, fault),
                      "add a key there");
  return camera;
}

}  // namespace kdray::cli
