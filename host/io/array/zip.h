// What    Writes a zip archive: files that are stored as they are, as NumPy's .npz has them.
// Shape   It is written forwards only, so that it can go to a pipe: a file's bytes are produced twice, to
//         know their number and checksum before they are written. Dates are the format's first, 1980-01-01,
//         so that the same arrays make the same archive. Where a size or a place doesn't fit 32 bits, zip64's
//         fields stand beside.
// Source  PKWARE's APPNOTE.TXT, 4.3 and 4.5.3.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/write_file.h"

namespace kdray::array {

class ZipWriter {
 public:
  // Sizes and places from `zip64_from` on are written as zip64 has them; tests set it lower.
  explicit ZipWriter(Sink sink, std::uint64_t zip64_from = 0xffffffffu)
      : sink_(std::move(sink)), zip64_from_(zip64_from) {}

  // `produce` is called twice, and hands over the same bytes each time. Names are plain ASCII.
  void add(const std::string& name, const std::function<void(const Sink&)>& produce);
  // Writes the directory, with which the archive ends.
  void finish();

 private:
  struct Entry {
    std::string name;
    std::uint64_t offset, size;
    std::uint32_t crc;
  };
  bool is_large(std::uint64_t value) const { return value >= zip64_from_; }
  void write(std::string_view bytes);
  std::string local_header(const Entry& entry) const;
  std::string directory_header(const Entry& entry) const;
  std::string directory_end(std::uint64_t begin, std::uint64_t size) const;

  Sink sink_;
  std::uint64_t zip64_from_, written_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace kdray::array
