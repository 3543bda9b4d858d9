// What    Gives a scene without camera or lights a three-quarter view of its bounding box and two lights
//         (docs/cli.md), and leaves alone what the file said. Where a few primitives reach far beyond
//         the others (a ground plane), the others are framed.
#pragma once

#include <functional>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

void frame_scene(Scene& scene);

// The same where the scene's primitives aren't here: so many of them, with these bounds.
struct Framed {
  DBox bounds;
  std::size_t n_primitives = 0;
  // Those of sampled_middles(), in any order; asked for where the scene has no camera.
  std::function<std::vector<dvec3>()> middles;
};
void frame_scene(Scene& scene, const Framed& framed);

// The middles of every step-th triangle and shape, by their places among those of their kind, of a scene of n
// primitives.
std::size_t step_of_samples(std::size_t n_primitives);
std::vector<dvec3> sampled_middles(const Scene& scene);

// The longer side of a picture that nobody gives a size.
inline constexpr int kDefaultSide = 1024;

// The scene's settings; where they have no size and the camera has an aspect ratio, with the size of that
// ratio whose longer side has kDefaultSide pixels.
RenderSettings settings_of(const Scene& scene);

// Width by height of the picture that the scene asks for.
double aspect_of(const RenderSettings& settings);

// A view from the front, the right and above (y is up, as in glTF and most OBJ files, unless `wanted` has
// another direction) onto `wanted.at`, from as near as lets all eight corners of the box into the picture.
Camera three_quarter_view(const DBox& world, const Camera& wanted, double aspect);

// How wide an orthographic picture has to be to show all of the box, and a margin; 0 for an empty one.
double width_to_show(const DBox& world, const Camera& camera, double aspect);

// Lights for the scene's camera, where there is anything to light.
void add_lights(Scene& scene);

}  // namespace kdray::scene
