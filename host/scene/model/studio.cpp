#include "scene/model/studio.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/local_space.h"

namespace kdray::scene {

namespace {

constexpr double kStudioFov = 0.5235987755982988;  // 30 degrees: as a portrait's lens
constexpr double kRoomFov = 1.0821041362364843;    // 62 degrees
constexpr double kBorder = 1.06;                   // the picture by what is in it, across and down
const dvec3 kFrontRightAbove(0.56, 0.36, 1);       // y is up

double radius_of(const DBox& box) {
  return safe_length(box.extent() * 0.5);
}

// Moves the camera, which looks along `view`, to where all corners of the box are in the picture and as many
// sides of it as possible are touched. Of each pair of sides, left and right, the corner that reaches
// farthest out gives a line that the eye lies behind; where the two lines cross, both sides are touched.
void fit(Camera& camera, const DBox& box, const Basis& view, double aspect) {
  const double tan_up = std::tan(camera.vertical_fov / 2) / kBorder, tan_side = tan_up * aspect;
  const dvec3 middle = box.center();
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  double right = kNone, left = kNone, above = kNone, below = kNone;
  for (const dvec3& corner : corners_of(box)) {
    const dvec3 p = corner - middle;
    const double x = glm::dot(p, view.right), y = glm::dot(p, view.up), depth = glm::dot(p, view.forward);
    right = std::max(right, x / tan_side - depth), left = std::max(left, -x / tan_side - depth);
    above = std::max(above, y / tan_up - depth), below = std::max(below, -y / tan_up - depth);
  }
  double distance = std::max((right + left) / 2, (above + below) / 2);
  if (!(distance > 0)) distance = 1;  // a single point
  const dvec3 aim =
      middle + view.right * (tan_side * (right - left) / 2) + view.up * (tan_up * (above - below) / 2);
  camera.from = aim - distance * view.forward;
  camera.at = aim;
}

// Makes the box one of a size of about 1 (frame.cpp does so too), so that no product leaves double's range.
void place_before(Camera& camera, const DBox& world, const dvec3& away, bool keeps_at, double aspect) {
  const double scale = scale_to_one(std::max(largest_component(world.lo), largest_component(world.hi)));
  const DBox box{world.lo * scale, world.hi * scale};
  Camera near = camera;
  near.at = keeps_at ? camera.at * scale : box.center();
  near.from = near.at + away;
  const Basis view = basis_of(near);
  if (keeps_at) {
    const double distance = distance_to_fit(corners_of(box), near, aspect, kBorder);
    near.from = near.at - view.forward * (distance > 0 ? distance : 1);
  } else {
    fit(near, box, view, aspect);
  }
  camera.from = near.from / scale, camera.at = near.at / scale;
}

}  // namespace

void set_studio_camera(Camera& camera, const Framing& framing, const View& view, double aspect) {
  const Studio& studio = *framing.studio;
  const bool inside = studio.room && !view.from && !view.side;
  camera.up = view.up.value_or(studio.up);
  camera.vertical_fov = view.vertical_fov.value_or(inside ? kRoomFov : kStudioFov);
  if (view.at) camera.at = *view.at;
  if (view.from || framing.box.empty()) return;
  if (inside) {
    camera.from = studio.room->from;
    if (!view.at) camera.at = studio.room->at;
    return;
  }
  const dvec3 usual = turned_to(camera.up, glm::normalize(view.side.value_or(kFrontRightAbove)));
  const dvec3 away = view.side ? usual : studio.open_to.value_or(usual);
  place_before(camera, framing.box, away, view.at.has_value(), aspect);
}

namespace {

struct Lamp {
  double right, up, back;  // the way to it, for a viewer who looks level at the scene's middle
  double size;             // its radius, by the distance
  vec3 color;
};

// From the left and above, warm; from the right, wide and cool; from behind, for the rim.
constexpr double kLampDistance = 6;  // radii of the scene
const Lamp kLamps[] = {{-0.75, 1.15, 0.75, 0.2, {0.80f, 0.77f, 0.72f}},
                       {1.0, 0.45, 0.7, 0.3, {0.24f, 0.26f, 0.29f}},
                       {0.45, 0.9, -1.0, 0.15, {0.34f, 0.35f, 0.37f}}};

// The backdrop's colours by height: mirrors show the upper ones.
const SkyStop kBackdrop[] = {{-0.75, {0.66f, 0.66f, 0.66f}},
                             {-0.25, {0.44f, 0.45f, 0.465f}},
                             {0.1, {0.27f, 0.285f, 0.31f}},
                             {0.45, {0.45f, 0.46f, 0.48f}},
                             {0.9, {1.0f, 1.0f, 1.0f}}};
const vec3 kFloorColor(0.60f, 0.60f, 0.60f);
constexpr float kFloorMirrors = 0.07f;
constexpr double kFloorInner = 0.9, kFloorRadius = 2.8;  // radii of the scene

// Returns right and forward on the level, and up.
Basis level_basis(const Camera& camera) {
  const Basis view = basis_of(camera);
  const dvec3 up = safe_normalize(camera.up);
  const dvec3 ahead = view.forward - up * glm::dot(view.forward, up);
  const dvec3 level = glm::length(ahead) > 1e-3 ? ahead : view.up - up * glm::dot(view.up, up);
  const dvec3 forward = glm::normalize(level);
  return {glm::cross(forward, up), up, forward};
}

Light lamp_at(const dvec3& position, double radius, const vec3& color) {
  Light light;
  light.kind = LightKind::sphere;
  light.position = position;
  light.radius = radius;
  light.color = color;
  return light;
}

// Returns how far below the box's middle it ends.
double lowest_of(const DBox& box, const dvec3& up) {
  double lowest = 0;
  for (const dvec3& corner : corners_of(box)) lowest = std::min(lowest, glm::dot(corner - box.center(), up));
  return lowest;
}

// A viewer below the floor, which isn't seen from there, has the lights below as well.
void light_object(Scene& scene, const Basis& level) {
  const DBox& box = scene.framing.box;
  const double radius = std::max(radius_of(box), std::numeric_limits<double>::min());
  const bool from_below = glm::dot(scene.camera->from - box.center(), level.up) < lowest_of(box, level.up);
  for (const Lamp& lamp : kLamps) {
    const double up = from_below ? -lamp.up : lamp.up;
    const dvec3 way = glm::normalize(level.right * lamp.right + level.up * up - level.forward * lamp.back);
    const double distance = kLampDistance * radius;
    scene.lights.push_back(lamp_at(box.center() + way * distance, lamp.size * distance, lamp.color));
  }
}

// A lamp in the upper half of the room, on the viewer's side, and one beside the viewer.
void light_room(Scene& scene, const Basis& level) {
  const DBox& box = scene.framing.box;
  const double radius = radius_of(box), height = std::abs(glm::dot(box.extent(), level.up));
  const dvec3 eye = scene.camera->from, middle = box.center();
  const dvec3 back = eye - middle, aside = back - level.up * glm::dot(back, level.up);
  const double step = std::min(0.3 * safe_length(aside), 0.2 * radius);
  const dvec3 lamp = middle + level.up * (0.25 * height) + safe_normalize(aside) * step;
  scene.lights.push_back(lamp_at(lamp, 0.07 * radius, vec3(0.62f, 0.61f, 0.58f)));
  scene.lights.push_back(lamp_at(eye + (level.right * 0.04 + level.up * 0.03) * radius, 0.03 * radius,
                                 vec3(0.30f, 0.31f, 0.32f)));
}

// Returns what the lights bring to the floor where nothing is in their way.
vec3 light_on_floor(const Scene& scene, const Floor& floor) {
  vec3 sum(0);
  for (const Light& light : scene.lights) {
    const double cosine = glm::dot(safe_normalize(light.position - floor.middle), floor.up);
    sum += light.color * static_cast<float>(std::max(0.0, cosine));
  }
  return sum;
}

// A floor of the background's colour, or of the studio's own, where it is lit by all lights.
Floor floor_under(const Scene& scene, const dvec3& up, const std::optional<vec3>& background) {
  const DBox& box = scene.framing.box;
  const double radius = radius_of(box);
  Floor floor{.middle = box.center() + up * lowest_of(box, up),
              .up = up,
              .inner = kFloorInner * radius,
              .radius = kFloorRadius * radius};
  const vec3 wanted = background.value_or(kFloorColor), light = light_on_floor(scene, floor);
  if (wanted == vec3(0) || glm::any(glm::lessThanEqual(light, vec3(0)))) return {};
  floor.unshadowed = wanted * 0.12f;
  floor.diffuse = wanted * 0.88f / light;
  floor.reflect = kFloorMirrors;
  return floor;
}

}  // namespace

void furnish_studio(Scene& scene, const View& view) {
  const DBox& box = scene.framing.box;
  const Studio& studio = *scene.framing.studio;
  const bool own = view.background || studio.own_background;
  const Basis level = level_basis(*scene.camera);
  if (!own) {
    scene.sky = {
        .kind = SkyKind::gradient, .up = level.up, .stops = {std::begin(kBackdrop), std::end(kBackdrop)}};
    scene.sky.brightest = brightest_of(scene.sky);
  }
  scene.framing.floor = {};
  if (box.empty()) return;
  if (studio.open_to || contains(box, scene.camera->from)) return light_room(scene, level);
  light_object(scene, level);
  if (!studio.stands) return;
  if (own && scene.sky.kind != SkyKind::none) return;  // a sky all around needs none
  scene.framing.floor = floor_under(scene, level.up, own ? std::optional(scene.background) : std::nullopt);
}

}  // namespace kdray::scene
