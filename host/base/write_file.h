// What    Output files, written whole or not at all: under a temporary name in the same folder first, then
//         renamed onto the target. A symbolic link is followed; a device or pipe is written directly, since a
//         rename would replace it. The permissions of a file that is replaced are kept. The temporary goes
//         with whatever ends the process (temporary.h).
// Errors  kdray::Error, ErrorCode::input: a folder, a missing folder, no permission, disk full.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace kdray {

// Returns where the bytes of `file` will go in the end: `file` itself, or what its symbolic links point to
// (which need not exist).
std::filesystem::path where_written(std::filesystem::path file);

// Calls `write(temporary)` and renames the temporary onto `file`; removes it if `write` throws.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path&)>& write);

// Writes content that is in memory: the usual case.
void write_file(const std::filesystem::path& file, std::string_view content);

// Throws what write_atomically would throw for this name, so that a long job can fail before it starts.
void check_writable(const std::filesystem::path& file);

// Takes the next bytes of what is being written.
using Sink = std::function<void(std::string_view)>;

// Appends to a file being written what `produce` hands to its sink, piece by piece; `shown` as below.
void write_pieces(const std::filesystem::path& temporary, const std::filesystem::path& shown,
                  const std::function<void(const Sink&)>& produce);

// Appends to a file being written, `shown` being the name for messages (the temporary's would puzzle the
// user).
void write_bytes(const std::filesystem::path& temporary, const std::filesystem::path& shown,
                 std::string_view content);

}  // namespace kdray
