// What    The view of a scene: frame_scene() gives one without camera or lights a three-quarter view of its
//         bounding box and two lights (docs/cli.md), and leaves alone what the file said; where a few
//         primitives reach far beyond the others (a ground plane), the others are framed. A View asks for
//         another one than that.
// Units   World units, angles in radians.
// Errors  kdray::Error, ErrorCode::usage: a camera that the file doesn't have, directions that make no view.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

void frame_scene(Scene& scene);

// What frame_scene() needs to know where the scene's primitives aren't here: their number and their bounds.
struct Framed {
  DBox bounds;
  std::size_t n_primitives = 0;
  // Returns what sampled_middles() would, in any order; called where the scene has no camera.
  std::function<std::vector<dvec3>()> middles;
};
void frame_scene(Scene& scene, const Framed& framed);

// Return the middles of every step-th triangle and shape, by their places among those of their kind, and the
// step for a scene of n primitives.
std::size_t step_of_samples(std::size_t n_primitives);
std::vector<dvec3> sampled_middles(const Scene& scene);

// The longer side of a picture whose size is not given.
inline constexpr int kDefaultSide = 1024;

// Returns the scene's settings. Where they have no size and the camera has an aspect ratio, the size has that
// ratio, and kDefaultSide pixels on its longer side.
RenderSettings settings_of(const Scene& scene);

// Returns the width divided by the height of the picture that the scene asks for.
double aspect_of(const RenderSettings& settings);

// Puts a size that is given into the settings. Of a side that is 0 where the other isn't, aspect_of() tells.
void set_size(RenderSettings& settings, int width, int height);

// Returns how far from `camera.at` the eye has to be, on the side where it is, to have all points in the
// picture; 0 where any distance does. `border`: how much larger the picture is than they are.
double distance_to_fit(std::span<const dvec3> points, const Camera& camera, double aspect, double border);

// Returns how wide an orthographic picture has to be to show all points, and a margin.
double width_to_show(std::span<const dvec3> points, const Camera& camera, double aspect);

// Right, up and forward of a camera, unit vectors.
struct Basis {
  dvec3 right, up, forward;
};
Basis basis_of(const Camera& camera);

std::array<dvec3, 8> corners_of(const DBox& box);

// Returns the rotation by the shortest way from y to `up`, of a vector.
dvec3 turned_to(const dvec3& up, const dvec3& v);

bool contains(const DBox& box, const dvec3& p);

// Adds lights for the scene's camera, where there is anything to light.
void add_lights(Scene& scene);

// What to see of a scene. Fields that are not set leave it as it is. Where the camera was made up, it is made
// up again about what is set, so that all is in the picture; lights that were made up for it follow it.
struct View {
  std::optional<int> camera = {};  // of Scene::cameras
  std::optional<dvec3> from = {}, at = {}, up = {};
  std::optional<dvec3> side = {};  // the way from the middle to a camera that is made up, with y up
  std::optional<double> vertical_fov = {};
  std::optional<double> ortho_width = {};  // parallel eye rays; 0: as wide as the scene needs
  std::optional<double> aperture = {}, focus = {};
  double headlight = 0;  // above 0: one more light, of this strength, at the camera
  std::optional<vec3> background = {};
};

// Returns the camera that the view asks for. `aspect` is the width divided by the height of the picture that
// will be made.
Camera camera_of(const Scene& scene, const View& view, double aspect);

// Puts that camera into the scene, with lights for it where they were made up, the headlight and the
// background. In a studio, also what else belongs to it. `first`: of a film's frames the first one, seen by
// the same view: what was made up for it is taken over, so that what moves does so in the film and light that
// is fixed stays as bright.
void set_view(Scene& scene, const View& view, double aspect, const Scene* first = nullptr);

}  // namespace kdray::scene
