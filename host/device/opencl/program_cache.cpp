#include "device/opencl/program_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "base/cache_folder.h"
#include "base/error.h"
#include "base/write_file.h"
#include "device/opencl/variant.h"

namespace kdray::device {

namespace {

std::string read_processor() {
  std::ifstream in("/proc/cpuinfo");
  std::string text;
  for (std::string line; std::getline(in, line) && !line.empty();)
    for (const std::string_view fact : {"vendor_id", "cpu family", "model", "stepping", "flags", "Features"})
      if (line.starts_with(fact)) text += line + '\n';
  return text;
}

// Returns what Linux says about the first core; an empty text elsewhere. It takes a tenth of a millisecond
// for each core.
const std::string& processor() {
  static const std::string text = read_processor();
  return text;
}

// Returns PoCL's variables, except those that only say where things are kept, or how many threads it has.
std::string pocl_environment() {
  std::vector<std::string> set;
  for (char** variable = environ; *variable; ++variable) {
    const std::string_view text = *variable;
    const bool is_of_no_program =
        text.starts_with("POCL_CACHE_DIR=") || text.starts_with("POCL_MAX_PTHREAD_COUNT=");
    if (text.starts_with("POCL_") && !is_of_no_program) set.emplace_back(text);
  }
  std::sort(set.begin(), set.end());
  return fmt::format("{}", fmt::join(set, "\n"));
}

}  // namespace

std::string identity_of(const cl::Device& device) {
  const cl::Platform platform(device.getInfo<CL_DEVICE_PLATFORM>());
  const bool cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", platform.getInfo<CL_PLATFORM_NAME>(),
                     platform.getInfo<CL_PLATFORM_VERSION>(), device.getInfo<CL_DEVICE_NAME>(),
                     device.getInfo<CL_DEVICE_VENDOR>(), device.getInfo<CL_DEVICE_VERSION>(),
                     device.getInfo<CL_DRIVER_VERSION>(), device.getInfo<CL_DEVICE_OPENCL_C_VERSION>(),
                     cpu ? processor() : "", pocl_environment());
}

Hash program_key(const std::string& identity, const std::string& source, const std::string& options) {
  // The lengths keep what belongs to one apart from what belongs to the next.
  return hash_of(fmt::format("kdray program 1 {} {} {}\n{}\n{}\n{}", identity.size(), options.size(),
                             source.size(), identity, options, source));
}

std::uint64_t family_of(const std::string& identity, const std::string& source, const std::string& options) {
  return program_key(identity, source, "family " + options).high;
}

ProgramKey variant_key(const std::string& identity, const std::string& source, const std::string& options,
                       std::uint64_t mask) {
  return {program_key(identity, source, options_with(options, mask)), family_of(identity, source, options),
          mask};
}

namespace {

constexpr std::array<char, 8> kMagic = {'k', 'd', 'r', 'a', 'y', 'p', 'r', '\n'};
constexpr std::uint64_t kVersion = 1;  // of the form of entries

struct Header {
  std::array<char, 8> magic;
  std::uint64_t version, n_bytes;
  Hash key;
  Hash bytes;   // their checksum
  Hash header;  // of all before it
};
static_assert(std::is_trivially_copyable_v<Header>);

Hash checksum(const Header& header) {
  return hash_of(&header, offsetof(Header, header));
}

Header header_of(const Hash& key, std::string_view bytes) {
  Header header{kMagic, kVersion, bytes.size(), key, hash_of(bytes), {}};
  header.header = checksum(header);
  return header;
}

}  // namespace

void write_entry(const std::filesystem::path& file, const Hash& key, std::string_view bytes) {
  const Header header = header_of(key, bytes);
  std::string entry(reinterpret_cast<const char*>(&header), sizeof header);
  entry += bytes;
  write_file(file, entry);
}

std::optional<std::string> read_entry(const std::filesystem::path& file, const Hash& key) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);  // a folder has none
  if (error || size < sizeof(Header)) return std::nullopt;
  std::string entry(size, '\0');
  if (!std::ifstream(file, std::ios::binary).read(entry.data(), static_cast<std::streamsize>(size)))
    return std::nullopt;
  Header header;
  std::memcpy(&header, entry.data(), sizeof header);
  entry.erase(0, sizeof header);
  const Header wanted = header_of(key, entry);
  if (std::memcmp(&header, &wanted, sizeof header) != 0) return std::nullopt;
  return entry;
}

namespace {

constexpr const char* kProgramEnding = ".program";

// Returns the binary of the program's first device; the others are parts of the same. Empty where the driver
// gives none.
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
  return entry_file(folder_, key.name, kProgramEnding);
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
  for (const Hash& name : keys_in(folder_, kProgramEnding))
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
  if (n > 0) shrink_folder(folder_, kProgramEnding, max_bytes_);
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
