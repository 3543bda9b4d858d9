// What    Refuses a picture, or rays, that this machine has no memory for, before hours are spent on them,
//         and says what would fit.
// Units   bytes.
// Errors  kdray::Error, ErrorCode::out_of_memory.
#pragma once

#include <cstdint>

namespace kdray::cli {

// What decides on the memory that a picture takes.
struct PictureNeeds {
  std::uint64_t width = 0, height = 0;
  std::uint64_t n_channels = 0;  // floats for each pixel beside the colour
  bool exr = false;              // else a PNG
  int bits = 8;                  // of a PNG
  bool adaptive = false;         // its sampling
  std::uint64_t n_queues = 1;
};

// Returns all that is held at one time, with the file, without the scene.
std::uint64_t picture_bytes(const PictureNeeds& picture);

void check_picture_fits(const PictureNeeds& picture, std::uint64_t free);

// Throws where `n_rays` of `trace`, which a Renderer traces, don't fit.
void check_rays_fit(std::uint64_t n_rays, std::uint64_t free);

// Throws where rows called `name` ("points"), which take so many bytes each with their answers, don't fit.
void check_rows_fit(const char* name, std::uint64_t n_rows, std::uint64_t bytes_each, std::uint64_t free);

}  // namespace kdray::cli
