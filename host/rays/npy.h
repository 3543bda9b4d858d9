// What    rays.npy in, hits.npy out (docs/cli.md): NumPy's format, versions 1 to 3, little endian.
// Shape   Rays: float32, N x 8, C order: origin xyz, t_min, direction xyz, t_max (kdray::Ray's bytes; 0 rows
//         allowed). Hits: structured [('t','<f4'),('primitive','<i4'),('u','<f4'),('v','<f4')], N.
// Errors  kdray::Error, ErrorCode::input: not NumPy, wrong type, order or shape, cut short; the message says
//         what was found and what is wanted. Rays themselves are not judged here.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "kdray/ray.h"

namespace kdray::rays {

std::vector<Ray> read_rays(const std::filesystem::path& file);
void write_hits(const std::filesystem::path& file, std::span<const Hit> hits);  // whole or not at all
std::string header_of_hits(std::size_t n_hits);  // what comes before the hits' own bytes

}  // namespace kdray::rays
