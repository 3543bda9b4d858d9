// What    Prepared scenes kept between runs: a scene that was read and built before is mapped from a file
//         (entry.h) instead.
// Shape   find() answers only where nothing that shaped the scene has changed: its file's content, the
//         options, the code, and every file that was read or missed on the way. The key, which the entry's
//         file is named by, is a hash of all of these but for the files that the scene's own file names; the
//         entry lists those.
// Why     The code's fingerprint is in the key: a loader or builder that was changed must not find what the
//         old one made.
// Errors  What is wrong with an entry makes find() answer nothing, never throw. keep() throws kdray::Error,
//         ErrorCode::input, when the folder can't be written.
#pragma once

#include <filesystem>
#include <optional>

#include "accel/prepare/prepared.h"
#include "base/hash.h"
#include "kdray/options.h"

namespace kdray::cache {

std::optional<prepare::Prepared> find(const CacheOptions& cache, const std::filesystem::path& scene,
                                      const TreeOptions& tree, const LoadOptions& load = {});

// Returns whether the scene was kept. It isn't where it doesn't come from a file, is too small to be worth
// it, or is too large.
bool keep(const CacheOptions& cache, const prepare::Prepared& prepared);

// Returns the key; `content` is the hash of the scene file's bytes.
Hash key_of(const std::filesystem::path& file, const Hash& content, const TreeOptions& tree,
            const LoadOptions& load);

}  // namespace kdray::cache
