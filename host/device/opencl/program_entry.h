// What    An entry of the program cache: some bytes in a file, under a key. The file is named by
//         the 32 hex digits of ProgramKey::name (program_key.h), with the ending .program; the key within is
//         ProgramKey::content.
// Shape   A header (magic, version, size, key, a checksum of the bytes and one of the header), then the
//         bytes.
// Why     PoCL ends the process when it is given a binary that was cut or changed: nothing may reach it that
//         is not byte for byte what was written.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/hash.h"

namespace kdray::device {

// Writes the entry whole or not at all. Throws kdray::Error, ErrorCode::input, when it can't be written.
void write_entry(const std::filesystem::path& file, const Hash& key, std::string_view bytes);

// Returns nothing where there is no entry, or where it is damaged, of another form or of another key.
std::optional<std::string> read_entry(const std::filesystem::path& file, const Hash& key);

}  // namespace kdray::device
