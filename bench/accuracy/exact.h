// What    Scenes of whose pictures the truth is known without rendering: `chessboard`, a floor with a
//         picture on it that reaches far away, each pixel the area's mean; `penumbra`, the soft shadow that
//         a straight edge throws in a rectangle's light, by the integral's closed form.
// Shape   The chessboard's mean is exact along a row and taken of thin rows across it. In the penumbra the
//         light at a point is exact, and a pixel is the mean of the points of a grid in it. What that leaves
//         open is told as the reference's own error: by how much a grid of half as many differs, and less.
// Units   Linear RGB; the scenes' lengths are their own.
#pragma once

#include <optional>
#include <string>

#include "bench/accuracy/shown.h"
#include "scene/model/scene.h"

namespace kdray::bench {

struct ExactScene {
  scene::Scene scene;
  Reference (*reference)(int width, int height);
};

// Nothing for any other name.
std::optional<ExactScene> exact_scene(const std::string& name);

}  // namespace kdray::bench
