// What    Which picture format a file is of: by its ending when writing, by its first bytes when reading.
// Errors  kdray::Error, ErrorCode::input: an ending that is none of ours, content that is none of ours.
#pragma once

#include <filesystem>
#include <string_view>

namespace kdray::image {

enum class PictureFormat { png, exr };

PictureFormat format_for_writing(const std::filesystem::path& file);
PictureFormat format_of_content(std::string_view bytes, const std::filesystem::path& file);

}  // namespace kdray::image
