// What    The URIs of glTF buffers: bytes in base64, and names of files below the scene's folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace kdray::scene::gltf {

// The bytes of "data:[type];base64,...", or nothing when it is not one.
std::optional<std::string> decode_data_uri(std::string_view uri);

// The text with each "%20" replaced by the character that it stands for.
std::string percent_decoded(std::string_view text);

// The path a relative URI names, percent-decoded; nothing for absolute paths, other schemes (http:), and what
// leads out of the folder.
std::optional<std::filesystem::path> relative_path_of(std::string_view uri);

}  // namespace kdray::scene::gltf
