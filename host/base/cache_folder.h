// What    A folder that entries of one kind are kept in, and its bound: the least recently used go first.
// Shape   An entry is "<32 hex digits><ending>"; its time of change is that of its last use. Files of other
//         names are left alone, so that entries of several kinds may share a folder. Several processes may
//         use, add and remove entries at once: an entry that is open or mapped stays readable when another
//         process removes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "base/hash.h"

namespace kdray {

// Returns the folder for what is kept between runs, by the XDG base directory specification:
// $XDG_CACHE_HOME/kdray or ~/.cache/kdray. Empty where there is no home.
std::filesystem::path user_cache_folder();

// Returns the entry's file. `ending` is that of the entries of its kind, as ".scene".
std::filesystem::path entry_file(const std::filesystem::path& folder, const Hash& key,
                                 std::string_view ending);

// Returns the keys of the entries that are in the folder now, in no order. A file that bears an entry's name
// need not be one: its reader has to check.
std::vector<Hash> keys_in(const std::filesystem::path& folder, std::string_view ending);

// Marks the entry as used just now; a folder that can only be read is no error.
void touch_entry(const std::filesystem::path& entry);

// Removes entries of this ending until no more than `max_bytes` are left, and what writers that were killed
// have left behind.
void shrink_folder(const std::filesystem::path& folder, std::string_view ending, std::uint64_t max_bytes);

}  // namespace kdray
