// What    A file's bytes in memory without a copy, for reading.
// Shape   The mapping lives as long as any owner of it, whatever becomes of the file's name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>

namespace kdray::cache {

struct MappedFile {
  std::shared_ptr<void> memory;  // page-aligned
  std::size_t size = 0;

  std::string_view bytes() const { return {static_cast<const char*>(memory.get()), size}; }
};

// Returns nothing where there is no such file, it is no regular file, or it can't be read.
std::optional<MappedFile> map_file(const std::filesystem::path& file);

}  // namespace kdray::cache
