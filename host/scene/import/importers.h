// What    One reader per format, each in its own file (nff.cpp, ply.cpp, ...). `text` is the whole
//         decompressed file; `file` names it in messages and is where other files (materials, buffers,
//         meshes) are looked for.
// Errors  kdray::Error, ErrorCode::input, with file and line (byte offset for binary formats).
#pragma once

#include <filesystem>
#include <string_view>

#include "scene/model/scene.h"

namespace kdray::scene {

Scene read_nff(std::string_view text, const std::filesystem::path& file);
Scene read_obj(std::string_view text, const std::filesystem::path& file);
Scene read_ply(std::string_view text, const std::filesystem::path& file);
Scene read_stl(std::string_view text, const std::filesystem::path& file);
Scene read_gltf(std::string_view text, const std::filesystem::path& file);  // .gltf and .glb
// Its animation at a time, where one is given.
Scene read_gltf(std::string_view text, const std::filesystem::path& file, const LoadOptions& options);
Scene read_json(std::string_view text, const std::filesystem::path& file);
Scene read_assimp(std::string_view text,
                  const std::filesystem::path& file);  // throws when built without assimp

}  // namespace kdray::scene
