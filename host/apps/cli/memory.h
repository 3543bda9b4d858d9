// What    Refuses a picture, or rays, that this machine has no memory for, before hours are spent on them,
//         and says what would fit.
// Units   bytes.
// Errors  kdray::Error, ErrorCode::out_of_memory.
#pragma once

#include <cstdint>

namespace kdray::cli {

// What of a picture decides on the memory that it takes.
struct PictureNeeds {
  std::uint64_t width = 0, height = 0;
  std::uint64_t n_channels = 0;  // floats for each pixel beside the colour
  bool exr = false;              // else a PNG
  int bits = 8;                  // of a PNG
  bool adaptive = false;         // its sampling
  std::uint64_t n_queues = 1;
};

// All that is held at one time, the file included, without the scene.
std::uint64_t picture_bytes(const PictureNeeds& picture);

void check_picture_fits(const PictureNeeds& picture, std::uint64_t free);

// `n_rays` of `trace` that a Renderer traces.
void check_rays_fit(std::uint64_t n_rays, std::uint64_t free);

// Rows of `name` ("points") that take so many bytes each, with their answers.
void check_rows_fit(const char* name, std::uint64_t n_rows, std::uint64_t bytes_each, std::uint64_t free);

}  // namespace kdray::cli
