// What    Reads a scene file by its ending: .nff .obj .ply .stl .gltf .glb .json, and through assimp, where
//         kdray was built with it, the other mesh formats; ".gz" and ".xz" after the ending of any format are
//         decompressed on the way. Fills in what a renderer needs and the file lacks (camera, lights:
//         frame.h).
// Errors  kdray::Error with ErrorCode::input: "file:line: what; what to do"; ErrorCode::usage for options
//         that are out of range.
#pragma once

#include <filesystem>
#include <string>

#include "scene/model/scene.h"

namespace kdray::scene {

Scene load(const std::filesystem::path& file, const LoadOptions& options = {});

// The same of a file's content. Its `name` tells the format, and the folder of the files that the scene
// names.
Scene load_from_memory(std::string bytes, const std::filesystem::path& name, const LoadOptions& options = {});

// What a scene without primitives, or an empty file in it, says.
std::string nothing_to_see(const std::string& name);

}  // namespace kdray::scene
