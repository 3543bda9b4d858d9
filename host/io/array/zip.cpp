#include "io/array/zip.h"

#include <zlib.h>

#include <utility>

namespace kdray::array {

namespace {

constexpr std::uint16_t kPlain = 20, kZip64 = 45;    // the version that it takes to unpack
constexpr std::uint16_t kUnix = 3 << 8;              // whose attributes files have
constexpr std::uint32_t kReadable = 0100644u << 16;  // a regular file
constexpr std::uint16_t kFirstDay = 1 << 5 | 1;      // 1980-01-01
constexpr std::uint32_t kBeside = 0xffffffffu;       // the value stands in zip64's fields
constexpr std::uint16_t kZip64Fields = 1;

// Little-endian fields, one after the other.
class Fields {
 public:
  template <class T>
  Fields& put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> 8 * i & 255);
    return *this;
  }
  Fields& put(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::uint32_t word(bool beside, std::uint64_t value) {
  return beside ? kBeside : static_cast<std::uint32_t>(value);
}

std::string zip64_fields(const std::vector<std::uint64_t>& values) {
  if (values.empty()) return {};
  Fields fields;
  fields.put(kZip64Fields).put(static_cast<std::uint16_t>(8 * values.size()));
  for (const std::uint64_t value : values) fields.put(value);
  return fields.bytes();
}

}  // namespace

void ZipWriter::write(std::string_view bytes) {
  sink_(bytes);
  written_ += bytes.size();
}

void ZipWriter::add(const std::string& name, const std::function<void(const Sink&)>& produce) {
  Entry entry{name, written_, 0, 0};
  produce([&entry](std::string_view piece) {
    entry.crc = static_cast<std::uint32_t>(
        ::crc32_z(entry.crc, reinterpret_cast<const Bytef*>(piece.data()), piece.size()));
    entry.size += piece.size();
  });
  write(local_header(entry));
  produce([this](std::string_view piece) { write(piece); });
  entries_.push_back(std::move(entry));
}

std::string ZipWriter::local_header(const Entry& e) const {
  const bool large = is_large(e.size);
  const std::string beside =
      large ? zip64_fields({e.size, e.size}) : std::string();  // as packed and as it is
  Fields f;
  f.put(std::uint32_t{0x04034b50}).put(large ? kZip64 : kPlain);
  f.put(std::uint16_t{0}).put(std::uint16_t{0});  // no flags; stored
  f.put(std::uint16_t{0}).put(kFirstDay);
  f.put(e.crc).put(word(large, e.size)).put(word(large, e.size));
  f.put(static_cast<std::uint16_t>(e.name.size())).put(static_cast<std::uint16_t>(beside.size()));
  return f.put(e.name).put(beside).bytes();
}

std::string ZipWriter::directory_header(const Entry& e) const {
  const bool large = is_large(e.size), far = is_large(e.offset);
  std::vector<std::uint64_t> values;
  if (large) values = {e.size, e.size};
  if (far) values.push_back(e.offset);
  const std::string beside = zip64_fields(values);
  const std::uint16_t version = values.empty() ? kPlain : kZip64;
  Fields f;
  f.put(std::uint32_t{0x02014b50}).put(static_cast<std::uint16_t>(kUnix | version)).put(version);
  f.put(std::uint16_t{0}).put(std::uint16_t{0});
  f.put(std::uint16_t{0}).put(kFirstDay);
  f.put(e.crc).put(word(large, e.size)).put(word(large, e.size));
  f.put(static_cast<std::uint16_t>(e.name.size())).put(static_cast<std::uint16_t>(beside.size()));
  f.put(std::uint16_t{0}).put(std::uint16_t{0}).put(std::uint16_t{0});  // no comment; disk 0; no text
  f.put(kReadable).put(word(far, e.offset));
  return f.put(e.name).put(beside).bytes();
}

// Returns the end of a directory of `size` bytes that begins at `begin`.
std::string ZipWriter::directory_end(std::uint64_t begin, std::uint64_t size) const {
  const bool large = is_large(size), far = is_large(begin);
  const std::uint64_t n = entries_.size();
  Fields f;
  if (large || far) {
    f.put(std::uint32_t{0x06064b50}).put(std::uint64_t{44});  // bytes that follow
    f.put(static_cast<std::uint16_t>(kUnix | kZip64)).put(kZip64);
    f.put(std::uint32_t{0}).put(std::uint32_t{0}).put(n).put(n).put(size).put(begin);
    f.put(std::uint32_t{0x07064b50}).put(std::uint32_t{0}).put(begin + size).put(std::uint32_t{1});
  }
  f.put(std::uint32_t{0x06054b50}).put(std::uint16_t{0}).put(std::uint16_t{0});
  f.put(static_cast<std::uint16_t>(n)).put(static_cast<std::uint16_t>(n));
  return f.put(word(large, size)).put(word(far, begin)).put(std::uint16_t{0}).bytes();
}

void ZipWriter::finish() {
  const std::uint64_t begin = written_;
  for (const Entry& entry : entries_) write(directory_header(entry));
  write(directory_end(begin, written_ - begin));
}

}  // namespace kdray::array
