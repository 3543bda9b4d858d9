// What    The lights of kdray's JSON scenes.
#pragma once

#include "scene/import/json/json_node.h"
#include "scene/model/scene.h"

namespace kdray::scene {

Light read_light(const JsonNode& node);

}  // namespace kdray::scene
