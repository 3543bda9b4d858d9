// What    Pictures that are made of others, since a map is one picture where a file has two: normals from
//         heights, and colours with the alpha of another picture.
// Units   As Picture has them: bytes. Heights and alpha are from 0 to 255.
#pragma once

#include <memory>
#include <optional>

#include "scene/textures/texturing.h"

namespace kdray::scene {

// Whether red, green and blue are the same everywhere.
bool is_grey(const Picture& picture);

// Normals of the relief whose heights a grey picture shows: where neighbours differ by 255 it is as steep as
// `strength`, from the middle of the two neighbours' difference along each axis. The picture repeats.
std::shared_ptr<const Picture> normals_of_heights(const Picture& heights, double strength);

// `colors` (white of the same size where there are none) with the alpha of `alpha`, which is its own where it
// has some, or else its red; of another size, that of the nearest of its texels.
std::shared_ptr<const Picture> with_alpha(const Picture* colors, const Picture& alpha);

// Whether all of the picture is either there or not.
bool is_cut_out(const Picture& picture);

}  // namespace kdray::scene
