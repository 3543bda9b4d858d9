// What    The background of kdray's JSON scenes: a colour, a gradient, or a picture all around.
#pragma once

#include <filesystem>

#include "scene/import/json/json_node.h"
#include "scene/model/scene.h"

namespace kdray::scene {

// Pictures are looked for in `folder`.
void read_background(const JsonNode& node, const std::filesystem::path& folder, Scene& scene);

}  // namespace kdray::scene
