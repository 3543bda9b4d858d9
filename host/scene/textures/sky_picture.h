// What    The picture all around of a sky, from a file: EXR, Radiance HDR, PNG or, where kdray was built with
//         libjpeg-turbo, JPEG; told by its first bytes.
// Shape   Linear RGB in floats. PNG and JPEG are codes of sRGB. What is no number, infinite or below 0 in an
//         EXR counts as 0, with a warning.
// Errors  kdray::Error, ErrorCode::input, in one line: another format, a damaged file, more texels than
//         textures may have (picture.h), told by the header before much is allocated.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/textures/sky.h"

namespace kdray::scene {

std::shared_ptr<const SkyPicture> read_sky_picture(const std::filesystem::path& file,
                                                   std::vector<std::string>& warnings);
std::shared_ptr<const SkyPicture> decode_sky_picture(std::string_view bytes, const std::string& name,
                                                     std::vector<std::string>& warnings);

// Refuses what has no texels or too many.
void check_sky_size(std::uint64_t width, std::uint64_t height, const std::string& name);

// radiance.cpp: "#?RADIANCE" or "#?RGBE".
SkyPicture decode_radiance(std::string_view bytes, const std::string& name);

}  // namespace kdray::scene
