// What    The folder that entries are kept in, and its bound: the least recently used go first.
// Shape   An entry is "<32 hex digits>.scene"; its time of change is that of its last use. Files of other names are left alone.
//         Several processes may use, add and remove entries at once: what is mapped stays, whoever removes its name.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/hash.h"

namespace kdray::cache {

std::filesystem::path entry_file(const std::filesystem::path& folder, const Hash& key);

// Marks the entry as used just now; that it can't be (a folder for reading only) is no error.
void touch(const std::filesystem::path& entry);

// Removes entries until no more than `max_bytes` are left, and what writers that were killed have left behind.
void shrink(const std::filesystem::path& folder, std::uint64_t max_bytes);

}  // namespace kdray::cache
