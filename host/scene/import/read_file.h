// What    A whole file in memory, decompressed when its name ends in .gz or .xz.
// Errors  kdray::Error, ErrorCode::input: missing, a folder, unreadable, damaged, or larger than `kMaxBytes`
//         unpacked; a Git LFS pointer or a web page in place of the file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace kdray::scene {

inline constexpr std::size_t kMaxBytes = std::size_t{4} << 30;

std::string read_file(const std::filesystem::path& file, std::size_t max_bytes = kMaxBytes);

// What these bytes of a file hold, by its name.
std::string unpacked(std::string bytes, const std::filesystem::path& file, std::size_t max_bytes = kMaxBytes);

// The ending that names the format, lower case, without ".gz"/".xz": "dragon.PLY.xz" -> ".ply".
std::string format_of(const std::filesystem::path& file);

}  // namespace kdray::scene
