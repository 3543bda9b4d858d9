// What    The name that a prepared scene is kept under: a hash of all that has a say in it but for the files
//         that the scene's own names. Those are listed in the entry.
// Why     The code's fingerprint is in it: a loader or builder that was changed must not find what the old
//         one made.
#pragma once

#include <filesystem>

#include "base/hash.h"
#include "kdray/options.h"

namespace kdray::cache {

// `content` is the hash of the scene file's bytes.
Hash key_of(const std::filesystem::path& file, const Hash& content, const TreeOptions& tree,
            const LoadOptions& load);

}  // namespace kdray::cache
