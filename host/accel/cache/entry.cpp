#include "accel/cache/entry.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cstring>
#include <string_view>
#include <vector>

#include "base/paged.h"
#include "base/write_file.h"

namespace kdray::cache {

namespace {

std::optional<MappedFile> map(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return MappedFile{};  // mmap refuses to map nothing
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  return MappedFile{{memory, [size](void* p) { ::munmap(p, size); }}, size};
}

}  // namespace

std::optional<MappedFile> map_file(const std::filesystem::path& file) {
  // A pipe is neither waited for (O_NONBLOCK) nor opened, which would end whoever writes into it.
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return std::nullopt;
  std::optional<MappedFile> mapped = map(descriptor);
  ::close(descriptor);
  return mapped;
}

namespace {

static_assert(std::endian::native == std::endian::little, "entries are in the machine's own order");

constexpr std::array<char, 8> kMagic = {'k', 'd', 'r', 'a', 'y', 's', 'c', '\n'};
constexpr std::uint32_t kVersion = 9;  // of the form of entries
constexpr std::size_t kPage = 4096;
constexpr std::size_t kPiece = std::size_t{1} << 20;  // hashed by one thread

// The facts; materials, their maps, lights and the arrays of the flat form but for the shapes' own; the wide
// form's nodes; and for each shape its array, for each kind its blocks.
constexpr std::size_t kSections = 1 + 3 + 14 + 1 + (primitives::kKinds - 1) + primitives::kKinds;

struct Section {
  std::uint64_t offset, bytes;
  std::uint64_t item;  // bytes of one
  Hash checksum;
};

struct Header {
  std::array<char, 8> magic;
  std::uint32_t version, n_sections;
  std::uint64_t file_bytes;
  Hash key;
  std::array<Section, kSections> sections;
  Hash checksum;  // of all before it
};
static_assert(sizeof(Header) <= kPage && std::is_trivially_copyable_v<Header>);

// Visits the arrays that an entry keeps as they lie in memory, in the order of the sections behind the facts.
template <class Prepared, class Visit>
void for_each_array(Prepared& p, const Visit& visit) {
  visit(p.settings.materials);
  visit(p.settings.texturing.material_maps);
  visit(p.settings.lights);
  flatten::for_each_flat_array(p.flat, visit);
  flatten::for_each_wide_array(p.wide, visit);
}

std::size_t to_page(std::size_t bytes) {
  return (bytes + kPage - 1) / kPage * kPage;
}

// Returns the hash of the pieces' hashes, which all cores work on.
Hash checksum(std::string_view bytes) {
  std::vector<Hash> pieces((bytes.size() + kPiece - 1) / kPiece);
  tbb::parallel_for(std::size_t{0}, pieces.size(),
                    [&](std::size_t i) { pieces[i] = hash_of(bytes.substr(i * kPiece, kPiece)); });
  return hash_of(pieces.data(), pieces.size() * sizeof(Hash));
}

Hash checksum(const Header& header) {
  return hash_of(&header, offsetof(Header, checksum));
}

struct Content {
  std::string_view bytes;
  std::size_t item;
};

// `facts` holds the bytes of the first section.
std::vector<Content> contents_of(const prepare::Prepared& prepared, const std::string& facts) {
  std::vector<Content> contents{{facts, 1}};
  for_each_array(prepared, [&](const auto& array) {
    constexpr std::size_t kItem = sizeof(*array.data());
    static_assert(std::is_trivially_copyable_v<std::remove_cvref_t<decltype(*array.data())>>);
    contents.push_back({{reinterpret_cast<const char*>(array.data()), array.size() * kItem}, kItem});
  });
  return contents;
}

Header header_of(const std::vector<Content>& contents, const Hash& key) {
  Header header{};
  header.magic = kMagic;
  header.version = kVersion;
  header.n_sections = kSections;
  header.key = key;
  std::size_t end = kPage;
  for (std::size_t i = 0; i < kSections; ++i) {
    const Content& c = contents.at(i);
    header.sections[i] = {to_page(end), c.bytes.size(), c.item, checksum(c.bytes)};
    end = to_page(end) + c.bytes.size();
  }
  header.file_bytes = end;
  header.checksum = checksum(header);
  return header;
}

std::string_view bytes_of(const Section& section, std::string_view file) {
  return file.substr(section.offset, section.bytes);
}

bool is_sound(const Header& header, const Hash& key, std::string_view file) {
  if (header.magic != kMagic || header.version != kVersion || header.n_sections != kSections) return false;
  if (header.checksum != checksum(header) || header.key != key || header.file_bytes != file.size())
    return false;
  for (const Section& s : header.sections)
    if (s.offset > file.size() || s.bytes > file.size() - s.offset ||
        s.checksum != checksum(bytes_of(s, file)))
      return false;
  return true;
}

// The array uses the mapping's bytes in place; the mapping lives as long as the array does.
template <class T>
void take(Array<T>& array, std::string_view bytes, const std::shared_ptr<void>& owner) {
  if (bytes.empty()) return;
  T* const first = reinterpret_cast<T*>(const_cast<char*>(bytes.data()));
  array = Array<T>(owner, first, bytes.size() / sizeof(T));
}

template <class T>
void take(std::vector<T>& values, std::string_view bytes, const std::shared_ptr<void>&) {
  values.resize(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
}

std::optional<prepare::Prepared> prepared_of(const Header& header, const MappedFile& file) {
  prepare::Prepared prepared;
  from_bytes(bytes_of(header.sections[0], file.bytes()), prepared);
  std::size_t i = 1;
  bool sizes_fit = true;
  for_each_array(prepared, [&](auto& array) {
    const Section& section = header.sections[i++];
    sizes_fit = sizes_fit && section.item == sizeof(*array.data()) && section.bytes % section.item == 0;
    if (sizes_fit) take(array, bytes_of(section, file.bytes()), file.memory);
  });
  if (!sizes_fit) return std::nullopt;
  Array<layout::u32>& texels = prepared.flat.texels;
  texels = {page_mapped(texels.owner(), texels.data(), texels.bytes()), texels.data(), texels.size()};
  return prepared;
}

}  // namespace

std::uint64_t entry_bytes(const prepare::Prepared& prepared) {
  const std::string facts = to_bytes(prepared);
  std::uint64_t end = kPage;
  for (const Content& c : contents_of(prepared, facts)) end = to_page(end) + c.bytes.size();
  return end;
}

void write_entry(const std::filesystem::path& file, const Hash& key, const prepare::Prepared& prepared) {
  const std::string facts = to_bytes(prepared);
  const std::vector<Content> contents = contents_of(prepared, facts);
  const Header header = header_of(contents, key);
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    std::size_t written = 0;
    const auto append = [&](std::string_view bytes) {
      write_bytes(temporary, file, bytes);
      written += bytes.size();
    };
    append({reinterpret_cast<const char*>(&header), sizeof header});
    for (std::size_t i = 0; i < kSections; ++i) {
      append(std::string(header.sections[i].offset - written, '\0'));
      append(contents[i].bytes);
    }
  });
}

std::optional<prepare::Prepared> read_entry(const std::filesystem::path& file, const Hash& key) {
  const std::optional<MappedFile> mapped = map_file(file);
  if (!mapped || mapped->size < sizeof(Header)) return std::nullopt;
  Header header;
  std::memcpy(&header, mapped->memory.get(), sizeof header);
  if (!is_sound(header, key, mapped->bytes())) return std::nullopt;
  try {
    return prepared_of(header, *mapped);
  } catch (const std::exception&) {
    return std::nullopt;  // facts of another form under a right checksum: not written by this code
  }
}

}  // namespace kdray::cache
