// What    Built programs kept between runs, as the binaries that OpenCL gives (docs/design/start.md).
// Shape   find() looks for an entry; built() only notes what had to be compiled; keep() writes the notes
//         down, when the picture is out. An entry's file is "<32 hex digits>.program", the digits those of
//         ProgramKey::name: a variant's family and mask, or the key itself (program_key.h). For one thing
//         PoCL compiles once more when it is asked for a binary; for another a binary that is asked for after
//         the first launch holds the machine code of that launch's work-group size too. Several threads and
//         processes may use a folder at once.
// Errors  None: an entry that is damaged, or that the driver refuses, counts as none; a folder that can't be
//         written is left.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/hash.h"
#include "device/opencl/opencl.h"
#include "device/opencl/program_key.h"

namespace kdray::device {

class ProgramCache {
 public:
  static constexpr std::uint64_t kMaxBytes = std::uint64_t{256} << 20;  // some 400 programs

  explicit ProgramCache(std::filesystem::path folder, std::uint64_t max_bytes = kMaxBytes)
      : folder_(std::move(folder)), max_bytes_(max_bytes) {}

  // The program of that key, ready to be used on all of these devices, which are parts of one.
  std::optional<cl::Program> find(const cl::Context& context, const std::vector<cl::Device>& devices,
                                  const ProgramKey& key, const std::string& options) const;

  // The masks of a family's programs (program_key.h) that are there, as far as names of files tell.
  std::vector<std::uint64_t> masks_of(std::uint64_t family) const;

  void built(const ProgramKey& key, const cl::Program& program);

  // Writes the new entries and returns their number. The least recently used entries go where the folder gets
  // too large.
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
