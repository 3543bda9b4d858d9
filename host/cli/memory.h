// What    Refuses a picture that this machine has no memory for, before hours are spent on it, and says
//         what would fit.
// Units   bytes.
// Errors  kdray::Error, ErrorCode::out_of_memory.
#pragma once

#include <cstdint>
#include <string>

namespace kdray::cli {

// What this process may still take: free memory, or what is left of its own limit. When nothing is known, it
// is all that there is.
std::uint64_t free_memory();

// `n_channels` floats for each pixel beside the colour.
std::uint64_t picture_bytes(std::uint64_t width, std::uint64_t height, std::uint64_t n_channels);

void check_picture_fits(std::uint64_t width, std::uint64_t height, std::uint64_t n_channels,
                        std::uint64_t free);

}  // namespace kdray::cli
