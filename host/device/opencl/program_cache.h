// What    Built programs kept between runs, as the binaries that OpenCL returns (docs/design/start.md): their
//         keys, the files that hold them, and the cache.
// Shape   A key is a hash of all that has a say in a program's binary: the whole source and the options; the
//         platform and the device with all their versions (PoCL's names its LLVM); on a CPU the processor's
//         model and features, since several machines may share a home directory; PoCL's environment
//         variables, which change what it compiles. A program of which there are variants (variant.h) is
//         filed under its family, which is all of that but the feature mask, and its mask: file names are the
//         only index. An entry is a file "<32 hex digits>.program", named by ProgramKey::name. It holds a
//         header (magic, version, size, ProgramKey::content, a checksum of the bytes and one of the header)
//         and the bytes.
// Why     PoCL ends the process when it is given a binary that was cut or changed: nothing may reach it that
//         is not byte for byte what was written.
// Errors  The cache has none: an entry that is damaged, or that the driver refuses, counts as none; a folder
//         that can't be written is left alone.
// Threads Several threads and processes may use a folder at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "device/opencl/opencl.h"

namespace kdray::device {

// Returns all that a key is made of but source and options, as text. Throws cl::Error.
std::string identity_of(const cl::Device& device);

Hash program_key(const std::string& identity, const std::string& source, const std::string& options);

// What an entry is checked by, and what its file is named by.
struct ProgramKey {
  Hash content;
  Hash name;

  ProgramKey(const Hash& key) : content(key), name(key) {}  // NOLINT: a key that is its own name
  ProgramKey(const Hash& whole, std::uint64_t family, std::uint64_t mask)
      : content(whole), name{family, mask} {}
};

// `options`: all but the mask, as Variant has them.
std::uint64_t family_of(const std::string& identity, const std::string& source, const std::string& options);
ProgramKey variant_key(const std::string& identity, const std::string& source, const std::string& options,
                       std::uint64_t mask);

// Writes an entry whole or not at all. Throws kdray::Error, ErrorCode::input, when it can't be written.
void write_entry(const std::filesystem::path& file, const Hash& key, std::string_view bytes);

// Returns nothing where there is no entry, or where it is damaged, of another form or of another key.
std::optional<std::string> read_entry(const std::filesystem::path& file, const Hash& key);

// find() looks for an entry; built() only notes what had to be compiled; keep() writes the notes to files,
// after the picture is written. A binary is asked for late because PoCL compiles once more when it is asked
// for one, and because after the first launch the binary also holds the machine code of that launch's
// work-group size.
class ProgramCache {
 public:
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{256} << 20;  // some 400 programs

  explicit ProgramCache(std::filesystem::path folder, std::uint64_t max_bytes = kMaxBytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  // Returns the program of that key, ready for all of these devices, which are parts of one.
  std::optional<cl::Program> find(const cl::Context& context, const std::vector<cl::Device>& devices,
                                  const ProgramKey& key, const std::string& options) const;

  // Returns the masks of a family's programs that are there, as far as file names tell.
  std::vector<std::uint64_t> masks_of(std::uint64_t family) const;

  void built(const ProgramKey& key, const cl::Program& program);

  // Writes the new entries and returns their number. Removes the least recently used entries where the folder
  // gets too large.
  std::size_t keep();

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path file_of(const ProgramKey& key) const;
  bool write(const ProgramKey& key, const std::string& bytes) const;

  std::filesystem::path folder_;
  std::uint64_t max_bytes_;
  std::mutex mutex_;
  std::vector<std::pair<ProgramKey, cl::Program>> built_;  // to be kept
};

}  // namespace kdray::device
