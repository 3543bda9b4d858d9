// What    The URIs of glTF buffers and pictures: bytes in base64, and names of files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::scene::gltf {

// The bytes of "data:[type];base64,...", or nothing when it is not one.
std::optional<std::string> decode_data_uri(std::string_view uri);

// The text with each "%20" replaced by the character that it stands for.
std::string percent_decoded(std::string_view text);

// The paths that a URI may mean, percent-decoded: as it stands, with backslashes as slashes, and without the
// query or fragment that web servers' files have behind their names. None for other schemes (http:).
std::vector<std::filesystem::path> paths_of(std::string_view uri);

}  // namespace kdray::scene::gltf
