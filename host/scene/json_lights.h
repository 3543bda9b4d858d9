// What    The lights of kdray's JSON scenes.
#pragma once

#include "scene/json_node.h"
#include "scene/scene.h"

namespace kdray::scene {

Light read_light(const JsonNode& node);

}  // namespace kdray::scene
