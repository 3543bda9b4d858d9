// What    What a glTF animation sampler says at a time: LINEAR, STEP and CUBICSPLINE, rotations along the
//         shorter arc.
// Shape   Before the first keyframe the value is the first one's, behind the last one the last one's.
// Units   Seconds.
// Errors  kdray::Error with the sampler's path, for values that are not as many as the keyframes want, and
//         those of gltf_accessor.h.
// Source  Khronos Group, "glTF 2.0 Specification", 2021, 3.11 and appendix C.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "base/vec.h"
#include "scene/import/gltf/gltf_document.h"

namespace kdray::scene::gltf {

dvec3 vector_at(Document& document, const JsonNode& sampler, double time);
glm::dquat rotation_at(Document& document, const JsonNode& sampler, double time);
// One for each of `n` morph targets.
std::vector<double> weights_at(Document& document, const JsonNode& sampler, double time, std::size_t n);

// The unit quaternion a share `t` of the way from one to another, of which -q is the same rotation as q.
glm::dquat slerp(const glm::dquat& from, const glm::dquat& to, double t);

}  // namespace kdray::scene::gltf
