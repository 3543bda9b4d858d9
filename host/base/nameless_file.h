// What    Memory whose pages are those of a file without a name: the system may write them out at any time,
//         and the file is gone when the memory is, or the process.
// Shape   The file's space is taken at once, so that a full disk is told here and ends no process later.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

namespace kdray {

// Zeroed, from the start of a page. Null, with errno, where there can be none.
std::shared_ptr<void> map_nameless_file(const std::filesystem::path& folder, std::size_t bytes);

}  // namespace kdray
