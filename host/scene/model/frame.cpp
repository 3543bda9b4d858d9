#include "scene/model/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/local_space.h"
#include "scene/model/check_scene.h"
#include "scene/model/studio.h"

namespace kdray::scene {

namespace {

constexpr double kFov = 0.6981317007977318;  // 40 degrees
constexpr double kMargin = 1.05;             // of the half picture: 2.5% of its height stay free on each side
const dvec3 kThreeQuarter(0.8, 0.6, 1.2);
constexpr float kKey = 0.75f, kFill = 0.25f;

// Returns the power of two that brings the box to a size of about 1. Cameras are made at that size.
double scale_of(const DBox& world) {
  return scale_to_one(std::max(largest_component(world.lo), largest_component(world.hi)));
}

Light directional(const dvec3& direction, float intensity) {
  Light light;
  light.kind = LightKind::directional;
  light.direction = glm::normalize(direction);
  light.color = vec3(intensity);
  return light;
}

Light point(const dvec3& position, float intensity) {
  Light light;
  light.position = position;
  light.color = vec3(intensity);
  return light;
}

// A key light from over the viewer's left shoulder and a weaker one from the right. A viewer inside the scene
// (a room) gets lamps instead, since walls would keep light from outside away: one at the eye and one beside
// it.
void add_lights_for_camera(Scene& scene, const DBox& box) {
  const Basis view = basis_of(*scene.camera);
  const dvec3 eye = scene.camera->from;
  if (contains(box, eye)) {
    const double step = 0.02 * safe_length(box.extent());
    scene.lights.push_back(point(eye, kKey));
    scene.lights.push_back(point(eye + step * view.up, kFill));
  } else {
    scene.lights.push_back(directional(view.forward + 0.5 * view.right - 0.7 * view.up, kKey));
    scene.lights.push_back(directional(view.forward - 0.9 * view.right - 0.1 * view.up, kFill));
  }
}

// Returns a view from a side, by default from the front, the right and above (y is up, as in glTF and most
// OBJ files, unless `wanted` has another direction), onto `wanted.at`, from as near as lets all eight corners
// of the box into the picture.
Camera view_of_all(const DBox& world, const Camera& wanted, double aspect,
                   const dvec3& side = kThreeQuarter) {
  const double scale = scale_of(world);
  Camera camera = wanted;
  camera.at *= scale;
  const dvec3 away = turned_to(camera.up, glm::normalize(side));
  camera.from = camera.at + away;
  double distance =
      distance_to_fit(corners_of({world.lo * scale, world.hi * scale}), camera, aspect, kMargin);
  if (!(distance > 0)) distance = scale;  // a single point
  camera.from = (camera.at + distance * away) / scale;
  camera.at /= scale;
  return camera;
}

// Returns the box of the middles of all but the outermost hundredth of the primitives, on each side of each
// axis.
DBox inner_box(std::vector<dvec3> middles) {
  DBox box;
  const std::size_t cut = middles.size() / 100;
  for (int k = 0; k < 3; ++k) {
    const auto below = [k](const dvec3& a, const dvec3& b) { return a[k] < b[k]; };
    std::nth_element(middles.begin(), middles.begin() + static_cast<std::ptrdiff_t>(cut), middles.end(),
                     below);
    box.lo[k] = middles[cut][k];
    std::nth_element(middles.begin(), middles.end() - 1 - static_cast<std::ptrdiff_t>(cut), middles.end(),
                     below);
    box.hi[k] = middles[middles.size() - 1 - cut][k];
  }
  return box;
}

// Returns what the camera should show: the bounding box, unless a few far or huge primitives (a ground plane,
// a stray vertex) would leave the scene itself a speck in it. Then it is the box of all the others, with a
// warning.
DBox worth_showing(Scene& scene, const Framed& framed) {
  constexpr double kSpeck = 4;
  constexpr std::size_t kFew = 100;  // with fewer primitives each of them matters
  const DBox& bounds = framed.bounds;
  if (framed.n_primitives < kFew) return bounds;
  DBox box = inner_box(framed.middles());
  const dvec3 margin = 0.05 * box.extent();
  box = intersection(DBox{box.lo - margin, box.hi + margin}, bounds);
  if (safe_length(box.extent()) * kSpeck > safe_length(bounds.extent())) return bounds;
  scene.warnings.push_back("a few primitives reach far beyond the others: the camera looks at the others");
  return box;
}

}  // namespace

// Directions in this file have y up.
dvec3 turned_to(const dvec3& up, const dvec3& v) {
  const dvec3 to = safe_normalize(up);
  if (to.y == 1) return v;
  if (to.y == -1) return {v.x, -v.y, -v.z};
  const dvec3 axis(to.z, 0, -to.x);  // y x up, as long as the sine of the angle
  return to.y * v + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1 + to.y));
}

Basis basis_of(const Camera& camera) {
  const dvec3 forward = safe_normalize(camera.at - camera.from);
  const dvec3 right =
      glm::normalize(glm::cross(forward, camera.up * scale_to_one(largest_component(camera.up))));
  return {right, glm::cross(right, forward), forward};
}

std::array<dvec3, 8> corners_of(const DBox& box) {
  std::array<dvec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i)
    corners[i] = {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
  return corners;
}

bool contains(const DBox& box, const dvec3& p) {
  return glm::all(glm::lessThanEqual(box.lo, p)) && glm::all(glm::lessThanEqual(p, box.hi));
}

RenderSettings settings_of(const Scene& scene) {
  RenderSettings settings = scene.settings;
  const double aspect = scene.camera ? scene.camera->aspect : 0;
  if (settings.width || settings.height || !(aspect > 0)) return settings;
  const auto side = [](double share) {
    return static_cast<int>(std::lround(kDefaultSide * std::clamp(share, 1.0 / kDefaultSide, 1.0)));
  };
  settings.width = side(aspect);
  settings.height = side(1 / aspect);
  return settings;
}

double aspect_of(const RenderSettings& settings) {
  if (!settings.width || !settings.height) return 1;
  return static_cast<double>(*settings.width) / *settings.height;
}

void set_size(RenderSettings& settings, int width, int height) {
  if (width <= 0 && height <= 0) return;
  const auto side = [](double length) { return static_cast<int>(std::lround(std::clamp(length, 1.0, 1e9))); };
  const double aspect = aspect_of(settings);
  settings.width = width > 0 ? width : side(height * aspect);
  settings.height = height > 0 ? height : side(width / aspect);
}

double distance_to_fit(std::span<const dvec3> points, const Camera& camera, double aspect, double border) {
  const Basis view = basis_of(camera);
  const double tan_up = std::tan(camera.vertical_fov / 2) / border;
  const double tan_side = tan_up * aspect;
  double distance = 0;
  for (const dvec3& point : points) {
    const dvec3 p = point - camera.at;
    const double sideways = std::abs(glm::dot(p, view.right)) / tan_side;
    const double upward = std::abs(glm::dot(p, view.up)) / tan_up;
    distance = std::max(distance, std::max(sideways, upward) - glm::dot(p, view.forward));
  }
  return distance;
}

double width_to_show(std::span<const dvec3> points, const Camera& camera, double aspect) {
  const Basis view = basis_of(camera);
  double half = 0;
  for (const dvec3& point : points) {
    const dvec3 p = point - camera.from;
    half = std::max({half, std::abs(glm::dot(p, view.right)), aspect * std::abs(glm::dot(p, view.up))});
  }
  return 2 * kMargin * half;
}

void add_lights(Scene& scene) {
  if (!scene.framing.box.empty()) add_lights_for_camera(scene, scene.framing.box);
}

// Returns the step that takes about kSampled primitives, evenly through the file.
std::size_t step_of_samples(std::size_t n_primitives) {
  constexpr std::size_t kSampled = 20000;
  return std::max<std::size_t>(1, n_primitives / kSampled);
}

std::vector<dvec3> sampled_middles(const Scene& scene) {
  const std::size_t step = step_of_samples(scene.primitive_count());
  std::vector<dvec3> middles;
  for (std::size_t i = 0; i < scene.triangles.size(); i += step) {
    const auto& v = scene.triangles[i].vertex;
    middles.push_back((scene.vertices[v[0]] + scene.vertices[v[1]] + scene.vertices[v[2]]) / 3.0);
  }
  primitives::for_each_shape([&](auto kind) {
    const auto& shapes = decltype(kind)::of(scene);
    for (std::size_t i = 0; i < shapes.size(); i += step) middles.push_back(middle_of(shapes[i]));
  });
  return middles;
}

void frame_scene(Scene& scene) {
  frame_scene(scene, {.bounds = scene.bounds(), .n_primitives = scene.primitive_count(), .middles = [&] {
                        return sampled_middles(scene);
                      }});
}

void frame_scene(Scene& scene, const Framed& framed) {
  const DBox known = scene.framing.box;
  const DBox box = !known.empty()                          ? known
                   : scene.camera || framed.bounds.empty() ? framed.bounds
                                                           : worth_showing(scene, framed);
  scene.framing = {.camera = !scene.camera,
                   .lights = scene.lights.empty() && !scene.unlit,
                   .box = box,
                   .illuminance = scene.framing.illuminance};
  if (!scene.camera) {
    const double scale = box.empty() ? 1 : scale_of(box);
    const Camera usual{.at = DBox{box.lo * scale, box.hi * scale}.center() / scale, .vertical_fov = kFov};
    scene.camera = box.empty() ? Camera{} : view_of_all(box, usual, aspect_of(scene.settings));
  }
  if (scene.framing.lights) add_lights(scene);
}

namespace {

const Camera& numbered_camera(const Scene& scene, int number) {
  const std::size_t n = scene.cameras.size();
  if (number >= 0 && static_cast<std::size_t>(number) < n)
    return scene.cameras[static_cast<std::size_t>(number)];
  const std::string there = n == 0   ? "has no camera"
                            : n == 1 ? "has one camera, number 0"
                                     : "has cameras 0 to " + std::to_string(n - 1);
  throw Error(ErrorCode::usage,
              "there is no camera " + std::to_string(number) + ": " + scene.name + " " + there);
}

// Returns the width that shows all; any width does where there is nothing.
double width_of(const DBox& box, const Camera& camera, double aspect) {
  const double width = box.empty() ? 0 : width_to_show(corners_of(box), camera, aspect);
  return width > 0 ? width : 1;
}

// Returns the light at the camera; where its rays are parallel, so is the light.
Light headlight(const Camera& camera, double strength) {
  Light light;
  light.kind = camera.ortho_width > 0 ? LightKind::directional : LightKind::point;
  light.position = camera.from;
  light.direction = safe_normalize(camera.at - camera.from);
  light.color = vec3(static_cast<float>(strength));
  return light;
}

// A camera that looks down or up has an up that leans.
dvec3 nearest_axis(const dvec3& up) {
  const dvec3 size = glm::abs(up);
  if (size.y >= size.x && size.y >= size.z) return {0, std::copysign(1.0, up.y), 0};
  return size.z >= size.x ? dvec3(0, 0, std::copysign(1.0, up.z)) : dvec3(std::copysign(1.0, up.x), 0, 0);
}

void check(const Camera& camera) {
  if (const char* const fault = fault_of(camera))
    throw Error(ErrorCode::usage,
                std::string("the view: ") + fault + "; give another place to look from or at, or another up");
}

bool is_made_up(const Scene& scene, const View& view) {
  return (scene.framing.camera || (view.side && !scene.framing.box.empty())) && !view.camera;
}

// Has what is made up for the scene be made up for what a film's first frame shows; or else a glTF file's own
// lights be as bright as there.
void take_over(const Scene& first, const View& view, Scene& scene) {
  Framing& framing = scene.framing;
  if (is_made_up(scene, view)) {
    const bool own_background = framing.studio && framing.studio->own_background;
    framing.box = first.framing.box;
    framing.studio = first.framing.studio;
    if (framing.studio) framing.studio->own_background = own_background;
    scene.settings.samples = first.settings.samples;
  }
  if (!framing.lights && first.framing.illuminance > 0 && framing.illuminance > 0)
    for (Light& light : scene.lights)
      light.color *= static_cast<float>(framing.illuminance / first.framing.illuminance);
}

}  // namespace

Camera camera_of(const Scene& scene, const View& view, double aspect) {
  Camera camera = view.camera ? numbered_camera(scene, *view.camera) : scene.camera.value_or(Camera{});
  const DBox& box = scene.framing.box;
  const bool made_up = is_made_up(scene, view);
  if (made_up && !scene.framing.camera)
    camera = {.at = box.center(), .up = nearest_axis(camera.up), .vertical_fov = kFov};
  if (made_up && scene.framing.studio) set_studio_camera(camera, scene.framing, view, aspect);
  if (view.from) camera.from = *view.from;
  if (view.at) camera.at = *view.at;
  if (view.up) camera.up = *view.up;
  if (view.vertical_fov) camera.vertical_fov = *view.vertical_fov, camera.ortho_width = 0;
  if (made_up && !scene.framing.studio && !view.from)
    camera = view_of_all(box, camera, std::min(aspect, aspect_of(scene.settings)),
                         view.side.value_or(kThreeQuarter));
  check(camera);
  if (view.ortho_width && *view.ortho_width > 0)
    camera.ortho_width = *view.ortho_width;
  else if (view.ortho_width)
    camera.ortho_width = width_of(box, camera, aspect);
  if (view.aperture) camera.aperture = *view.aperture;
  if (view.focus) camera.focus = *view.focus;
  return camera;
}

void set_view(Scene& scene, const View& view, double aspect, const Scene* first) {
  const bool has_firsts = first && is_made_up(scene, view);
  if (first) take_over(*first, view, scene);
  scene.camera = has_firsts ? first->camera : camera_of(scene, view, aspect);
  if (first && view.ortho_width == 0.0) scene.camera->ortho_width = first->camera->ortho_width;
  if (view.background) scene.background = *view.background, scene.sky = {};
  if (scene.framing.lights) {
    scene.lights.clear();
    scene.framing.studio ? furnish_studio(scene, view) : add_lights(scene);
  }
  if (view.headlight > 0) scene.lights.push_back(headlight(*scene.camera, view.headlight));
}

}  // namespace kdray::scene
