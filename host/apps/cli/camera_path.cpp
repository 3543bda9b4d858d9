#include "apps/cli/camera_path.h"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/box.h"
#include "base/error.h"
#include "base/local_space.h"
#include "base/vec.h"
#include "scene/import/files.h"
#include "scene/import/json/json_node.h"
#include "scene/model/check_scene.h"
#include "scene/model/frame.h"

namespace kdray::cli {

namespace {

constexpr std::string_view kFileKeys[] = {"kdray_camera_path", "interpolation", "keys"};
constexpr std::string_view kCameraKeys[] = {"frame", "from",   "at",       "up",   "fov",
                                            "ortho", "hither", "aperture", "focus"};
constexpr int kMostFrame = 999999;

struct Own {
  std::string_view key;
  double Camera::*value;
};
constexpr Own kOwnKeys[] = {{"ortho", &Camera::ortho_width},
                            {"hither", &Camera::hither},
                            {"aperture", &Camera::aperture},
                            {"focus", &Camera::focus}};

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
  for (const Own& own : kOwnKeys)
    if (const auto value = node.find(own.key)) camera.*own.value = value->number_between(0, 1e30);
  if (const char* const fault = fault_in(camera)) throw node.error(fault);
  return camera;
}

}  // namespace

CameraPath::CameraPath(const std::filesystem::path& file) : file_(file.string()) {
  const nlohmann::json document = scene::parse_json(scene::read_file(file), file_);
  const scene::JsonNode root(document, file_);
  root.expect_keys({"camera path", kFileKeys});
  const auto version = root.find("kdray_camera_path");
  if (!version) throw input_error(file_, 0, "is no camera path", "begin it with \"kdray_camera_path\": 1");
  (void)version->integer(1, 1);
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
    for (std::size_t k = 0; k < kOwn; ++k) {
      const bool has = node.find(kOwnKeys[k].key).has_value();
      if (!keys_.empty() && has != has_[k])
        throw node.error(fmt::format("'{}' is in some keys and not in others", kOwnKeys[k].key));
      has_[k] = has;
    }
    has_fov_ |= node.find("fov").has_value();
    keys_.push_back({frame,
                     {c.from[0], c.from[1], c.from[2], c.at[0], c.at[1], c.at[2], c.up[0], c.up[1], c.up[2],
                      c.fov, c.ortho_width, c.hither, c.aperture, c.focus}});
  }
  if (keys_.empty()) throw root["keys"].expected("one key at least");
  for (const std::size_t k : {std::size_t{0}, kOwn - 1}) {  // 0 is no small one
    const auto is_none = [k](const Key& key) { return key.values[kPlaced + k] == 0; };
    if (std::ranges::any_of(keys_, is_none) && !std::ranges::all_of(keys_, is_none))
      throw root["keys"].error(fmt::format("'{}' is 0 in some keys and not in others", kOwnKeys[k].key));
  }
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

Camera CameraPath::at(int frame, const Camera& own) const {
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
  Camera camera = own;
  camera.from = {v[0], v[1], v[2]};
  camera.at = {v[3], v[4], v[5]};
  camera.up = {v[6], v[7], v[8]};
  camera.fov = v[9];
  for (std::size_t k = 0; k < kOwn; ++k)
    if (has_[k]) camera.*kOwnKeys[k].value = std::max(0.0, v[kPlaced + k]);  // a smooth curve may swing below
  if (has_fov_ && !has_[0]) camera.ortho_width = 0;
  if (const char* const fault = fault_in(camera))
    throw input_error(file_, 0, fmt::format("between its keys, at frame {}: {}", frame, fault),
                      "add a key there");
  return camera;
}

namespace {

View::Vector numbers_of(const dvec3& v) {
  return {v.x, v.y, v.z};
}

constexpr double kBorder = 1.06;  // of the picture, around all that is seen in any frame

// Returns points about all that the box passes when it is turned about the line through `middle` along
// `axis`, of unit length: the corners of a prism around a cylinder.
std::vector<dvec3> passed_by(const DBox& box, const dvec3& middle, const dvec3& axis) {
  double radius = 0, half_length = 0;
  for (const dvec3& corner : scene::corners_of(box)) {
    const double along = glm::dot(corner - middle, axis);
    half_length = std::max(half_length, std::abs(along));
    radius = std::max(radius, safe_length(corner - middle - along * axis));
  }
  constexpr int kSides = 32;
  const double reach = radius / std::cos(std::numbers::pi / kSides);
  std::vector<dvec3> points;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const dvec3 out = scene::turned_to(axis, {reach * std::cos(angle), 0, reach * std::sin(angle)});
    points.push_back(middle + out + half_length * axis);
    points.push_back(middle + out - half_length * axis);
  }
  return points;
}

}  // namespace

Turntable::Turntable(const scene::Scene& seen, const View& asked, double aspect)
    : asked_(asked), camera_(seen.camera.value_or(scene::Camera{})) {
  const scene::Framing& framing = seen.framing;
  const bool is_chosen = framing.camera && !asked.camera && !asked.from;
  if (!is_chosen || framing.box.empty()) return;
  looks_around_ = framing.studio && framing.studio->room;
  if (looks_around_) return;
  const dvec3 way = camera_.from - camera_.at, away = safe_normalize(way);
  if (!asked.at) camera_.at = framing.box.center();
  camera_.from = camera_.at + way;
  const std::vector<dvec3> points = passed_by(framing.box, camera_.at, safe_normalize(camera_.up));
  if (const double distance = scene::distance_to_fit(points, camera_, aspect, kBorder); distance > 0)
    camera_.from = camera_.at + away * distance;
  if (camera_.ortho_width > 0 && asked.ortho_width == 0.0)
    camera_.ortho_width = scene::width_to_show(points, camera_, aspect);
}

View Turntable::after(double turns) const {
  const dvec3& middle = looks_around_ ? camera_.from : camera_.at;
  const auto rotation = glm::rotate(dmat4(1), 2 * std::numbers::pi * turns, safe_normalize(camera_.up));
  const auto turned = [&](const dvec3& p) { return middle + dvec3(rotation * glm::dvec4(p - middle, 0)); };
  View view = asked_;
  view.from = numbers_of(turned(camera_.from));
  view.at = numbers_of(turned(camera_.at));
  view.up = numbers_of(camera_.up);
  if (camera_.ortho_width > 0) view.ortho_width = camera_.ortho_width;
  if (looks_around_ && !view.fov) view.fov = glm::degrees(camera_.vertical_fov);
  return view;
}

}  // namespace kdray::cli
