// What    Reads a file by its ending as load() does, but leaves the scene as the file has it: no camera or
//         lights are made up. For files that include others.
// Errors  The errors are those of load().
#pragma once

#include <filesystem>

#include "scene/model/scene.h"

namespace kdray::scene {

Scene import_scene(const std::filesystem::path& file);

}  // namespace kdray::scene
