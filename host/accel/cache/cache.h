// What    Prepared scenes kept between runs: a scene that was read and built before is mapped from a file
//         (entry.h) instead.
// Shape   find() answers only where nothing that shaped the scene has changed: its file's content, the
//         options, the code (key.h), and every file that was read or missed on the way.
// Errors  What is wrong with an entry makes find() answer nothing, never throw. keep() throws kdray::Error,
//         ErrorCode::input, when the folder can't be written.
#pragma once

#include <filesystem>
#include <optional>

#include "accel/prepare/prepared.h"

namespace kdray::cache {

std::optional<prepare::Prepared> find(const CacheOptions& cache, const std::filesystem::path& scene,
                                      const TreeOptions& tree, const LoadOptions& load = {});

// Whether the scene was kept. It isn't where it doesn't come from a file, is too small to be worth it, or is
// too large.
bool keep(const CacheOptions& cache, const prepare::Prepared& prepared);

}  // namespace kdray::cache
