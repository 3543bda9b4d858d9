// What    Reads a scene file by its ending: .nff .obj .ply .stl .gltf .glb .json, and through assimp, where
//         kdray was built with it, the other mesh formats; ".gz" and ".xz" after the ending of any format are
//         decompressed on the way. Fills in what a renderer needs and the file lacks (camera, lights:
//         frame.h).
// Errors  kdray::Error with ErrorCode::input: "file:line: what; what to do"; ErrorCode::usage for options
//         that are out of range.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/model/scene.h"

namespace kdray::scene {

Scene load(const std::filesystem::path& file, const LoadOptions& options = {});

// Reads a scene from a file's content. Its `name` gives the format, and the folder of the files that the
// scene names.
Scene load_from_memory(std::string bytes, const std::filesystem::path& name, const LoadOptions& options = {});

// Returns whether the name ends as those of scenes do that load() reads.
bool is_scene_name(const std::filesystem::path& file);

// Returns the warning about a scene without primitives, or about an empty file in it.
std::string nothing_to_see(const std::string& name);

// What this kdray can or can't read, depending on libraries that are optional when it is built; users see the
// list.
struct Ability {
  const char* what;     // "Draco-compressed meshes"
  const char* package;  // Debian's, which it takes to have it: "libdraco-dev"
  bool here;            // kdray was built with it
};

const std::vector<Ability>& abilities();

// ---- One reader for each format, in its own file (nff.cpp, ply.cpp, ...). `text` is the whole decompressed
// file; `file` names it in messages and is where other files (materials, buffers, meshes) are looked for.
// Errors have a byte offset in place of the line for binary formats.

Scene read_nff(std::string_view text, const std::filesystem::path& file);
Scene read_obj(std::string_view text, const std::filesystem::path& file);
Scene read_ply(std::string_view text, const std::filesystem::path& file);
Scene read_stl(std::string_view text, const std::filesystem::path& file);
Scene read_gltf(std::string_view text, const std::filesystem::path& file);  // .gltf and .glb
// Reads the scene at a time of its animation, where one is given.
Scene read_gltf(std::string_view text, const std::filesystem::path& file, const LoadOptions& options);
Scene read_json(std::string_view text, const std::filesystem::path& file);
Scene read_assimp(std::string_view text,
                  const std::filesystem::path& file);  // throws when built without assimp

// Reads a file by its ending as load() does, but leaves the scene as the file has it: no camera or lights are
// made up. For files that include others.
// `keep_texcoords`: though the file names no picture, as one will be laid on.
Scene import_scene(const std::filesystem::path& file, bool keep_texcoords = false);

// Returns whether readers keep them so of the file in work.
bool keeps_texcoords();

}  // namespace kdray::scene
