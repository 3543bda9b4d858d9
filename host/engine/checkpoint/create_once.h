// What    A small file that only one process can make, whole, in a folder that several machines see: what a
//         checkpoint's header and its leases are.
// Shape   It is written under a name of its own and then linked to the one that is wanted, which fails where
//         that is taken; where the file system has no links, it is made with O_EXCL and then written, so that
//         readers may find it empty for a moment.
// Why     Both are atomic on NFS, where locks of files are not to be relied on.
// Errors  ErrorCode::input when the folder can't be written.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kdray::checkpoint {

// False: there is such a file already.
bool create_once(const std::filesystem::path& file, std::string_view content);

// Nothing where there is no such file.
std::string read_small(const std::filesystem::path& file, std::size_t most);

// "node7-1234-89abcdef": no other process has the same, whatever machine it is on.
std::string new_owner();

}  // namespace kdray::checkpoint
