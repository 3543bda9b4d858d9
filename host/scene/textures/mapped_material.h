// What    What a material becomes that a program, or kdray's JSON, gives pictures: its terms, parted into
//         what they multiply, which goes to its maps, and what they leave alone.
// Shape   With a picture of metal all terms but the emission follow from the base colour, as glTF's do.
#pragma once

#include "scene/model/scene.h"
#include "scene/textures/texturing.h"

namespace kdray::scene {

// `maps` has its textures, alpha's mode, what the emission's picture is multiplied by, and metal's factors.
Material with_pictures(const Material& terms, const MaterialMaps& maps, Texturing& texturing);

// The rule by which factors of pictures are refused; nullptr where there is nothing to refuse.
const char* fault_of_factors(const MaterialMaps& maps);

}  // namespace kdray::scene
