// What    An entry of the scene cache: a prepared scene in a file, which is mapped to be used as it is
//         (docs/design/cache.md).
// Shape   A header of a page: magic, version, key, size, and a table of sections with the checksum of each;
//         then the sections, each from the start of a page: the facts (facts.h), materials, maps, lights,
//         and the arrays of FlatScene and WideForm.
// Why     Kernels follow the indices in these arrays without a further look, so nothing is used that is not
//         byte for byte what was written: every section has a checksum, and so has the header.
#pragma once

#include <filesystem>
#include <optional>

#include "accel/prepare/prepared.h"
#include "base/hash.h"

namespace kdray::cache {

// The size of the entry's file.
std::uint64_t entry_bytes(const prepare::Prepared& prepared);

// Writes the entry whole or not at all. Throws kdray::Error, ErrorCode::input, when it can't be written.
void write_entry(const std::filesystem::path& file, const Hash& key, const prepare::Prepared& prepared);

// Returns nothing where there is no entry, or where it is damaged, of another form or of another key.
std::optional<prepare::Prepared> read_entry(const std::filesystem::path& file, const Hash& key);

}  // namespace kdray::cache
