#include "device/opencl/program_entry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>
#include <type_traits>

#include "base/write_file.h"

namespace kdray::device {

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

}  // namespace kdray::device
