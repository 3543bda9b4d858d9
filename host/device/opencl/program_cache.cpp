#include "device/opencl/program_cache.h"

#include <algorithm>
#include <system_error>

#include "base/cache_folder.h"
#include "base/error.h"
#include "device/opencl/program_entry.h"

namespace kdray::device {

namespace {

constexpr const char* kEnding = ".program";

// The binary of the program's first device; the others are parts of the same. Empty where the driver gives
// none.
std::string binary_of(const cl::Program& program) {
  try {
    const std::vector<std::vector<unsigned char>> binaries = program.getInfo<CL_PROGRAM_BINARIES>();
    return binaries.empty() ? "" : std::string(binaries.front().begin(), binaries.front().end());
  } catch (const cl::Error&) {
    return "";
  }
}

}  // namespace

std::filesystem::path ProgramCache::file_of(const ProgramKey& key) const {
  return entry_file(folder_, key.name, kEnding);
}

std::optional<cl::Program> ProgramCache::find(const cl::Context& context,
                                              const std::vector<cl::Device>& devices, const ProgramKey& key,
                                              const std::string& options) const {
  const std::filesystem::path file = file_of(key);
  const std::optional<std::string> bytes = read_entry(file, key.content);
  if (!bytes) return std::nullopt;
  try {
    const std::vector<unsigned char> binary(bytes->begin(), bytes->end());
    cl::Program program(context, devices, cl::Program::Binaries(devices.size(), binary));
    program.build(devices, options.c_str());
    touch_entry(file);
    return program;
  } catch (const cl::Error&) {
    return std::nullopt;
  }
}

std::vector<std::uint64_t> ProgramCache::masks_of(std::uint64_t family) const {
  std::vector<std::uint64_t> masks;
  for (const Hash& name : keys_in(folder_, kEnding))
    if (name.high == family) masks.push_back(name.low);
  return masks;
}

void ProgramCache::built(const ProgramKey& key, const cl::Program& program) {
  const std::lock_guard lock(mutex_);
  const bool known = std::any_of(built_.begin(), built_.end(),
                                 [&](const auto& noted) { return noted.first.content == key.content; });
  if (!known) built_.emplace_back(key, program);
}

std::size_t ProgramCache::keep() {
  std::vector<std::pair<ProgramKey, cl::Program>> built;
  {
    const std::lock_guard lock(mutex_);
    built.swap(built_);
  }
  std::size_t n = 0;
  for (const auto& [key, program] : built) {
    const std::string binary = binary_of(program);
    if (!binary.empty() && write(key, binary)) ++n;
  }
  if (n > 0) shrink_folder(folder_, kEnding, max_bytes_);
  return n;
}

bool ProgramCache::write(const ProgramKey& key, const std::string& bytes) const {
  try {
    std::error_code error;  // told by write_entry
    std::filesystem::create_directories(folder_, error);
    write_entry(file_of(key), key.content, bytes);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace kdray::device
