// What    The lights (KHR_lights_punctual) and the camera of a glTF scene, placed by their nodes.
// Units   glTF's lights are photometric and leave the exposure to the viewer. Here the scene is exposed so
//         that all lights together, unobstructed, give an illuminance of 1 at the middle of the scene: the
//         same light as a light of intensity 1 without attenuation.
#pragma once

#include <vector>

#include "base/vec.h"
#include "scene/import/gltf/gltf_document.h"
#include "scene/model/scene.h"

namespace kdray::scene::gltf {

// `light` is an entry of KHR_lights_punctual's lights, at a node with the transform `to_world`.
Light read_light(const JsonNode& light, const dmat4& to_world);

// Scales the lights' colours so that the exposure is as above, and notes it in the scene's framing. The
// scene's geometry must be there.
void expose(Scene& scene);

// Cameras of glTF files look in a direction. Makes what they look at the point on their way that is as far
// off as the middle of the scene, where that lies ahead: what pictures are turned around, and where a lens is
// focused.
void aim_cameras(Scene& scene);

// Returns nothing, and warns, for a camera that isn't perspective or has no view direction.
std::optional<Camera> read_camera(const JsonNode& camera, const dmat4& to_world,
                                  std::vector<std::string>& warnings);

}  // namespace kdray::scene::gltf
