// What    Checks that a scene from any importer keeps what scene.h promises, so that no later module has to.
// Errors  check_scene throws kdray::Error: ErrorCode::input for values a file can be at fault for (not
//         finite, out of range, too many), ErrorCode::internal for indices, which only an importer can get
//         wrong.
#pragma once

#include <cstdint>

#include "scene/model/scene.h"

namespace kdray::scene {

// References of the kd-tree (kernels/layout/tree.layout.h) have 28 bits for the index within a kind.
inline constexpr std::uint64_t kMaxPrimitivesPerKind = std::uint64_t{1} << 28;

void check_scene(const Scene& scene);

// Returns what is wrong with a camera, material or light; null when nothing is.
const char* fault_of(const Camera& camera);
const char* fault_of(const Material& material);
const char* fault_of(const Light& light);

}  // namespace kdray::scene
