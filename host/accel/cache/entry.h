// What    An entry of the scene cache: a prepared scene in a file, which is mapped and used as it is
//         (docs/design/cache.md).
// Shape   A header of a page: magic, version, key, size, and a table of sections with the checksum of each;
//         then the sections, each from the start of a page: the facts, materials, maps, lights, and the
//         arrays of FlatScene and WideForm. The facts are what a prepared scene has beside its arrays, as
//         CBOR (RFC 8949; facts.cpp).
// Why     Kernels follow the indices in these arrays without checking them, so nothing is used that is not
//         byte for byte what was written: every section has a checksum, and so has the header.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "accel/prepare/prepared.h"
#include "base/hash.h"

namespace kdray::cache {

// Returns the size of the entry's file.
std::uint64_t entry_bytes(const prepare::Prepared& prepared);

// Writes the entry whole or not at all. Throws kdray::Error, ErrorCode::input, when it can't be written.
void write_entry(const std::filesystem::path& file, const Hash& key, const prepare::Prepared& prepared);

// Returns nothing where there is no entry, or where it is damaged, of another form or of another key.
std::optional<prepare::Prepared> read_entry(const std::filesystem::path& file, const Hash& key);

// Returns the facts as bytes.
std::string to_bytes(const prepare::Prepared& prepared);

// Fills in all but the arrays, materials and lights. Throws std::exception where the bytes were not made by
// to_bytes.
void from_bytes(std::string_view bytes, prepare::Prepared& prepared);

// A file's bytes in memory without a copy, for reading. The mapping lives as long as any owner of it,
// whatever becomes of the file's name.
struct MappedFile {
  std::shared_ptr<void> memory;  // page-aligned
  std::size_t size = 0;

  std::string_view bytes() const { return {static_cast<const char*>(memory.get()), size}; }
};

// Returns nothing where there is no such file, it is no regular file, or it can't be read.
std::optional<MappedFile> map_file(const std::filesystem::path& file);

}  // namespace kdray::cache
