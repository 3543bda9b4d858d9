// What    The header of a NumPy file: a magic number, a version, a length, and a Python dictionary in text.
// Errors  kdray::Error, ErrorCode::input, naming `file`: not NumPy, an unknown version, a damaged dictionary.
// Source  numpy.lib.format: versions 1 (16-bit length), 2 (32-bit length) and 3 (UTF-8 names).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::array {

struct NpyHeader {
  std::string type;  // '<f4' of a plain type; the Python text of a structured one, e.g. [('t', '<f4')]
  bool structured = false;
  bool fortran_order = false;
  std::vector<std::uint64_t> shape;
};

constexpr std::size_t kPreambleBytes = 12;  // magic, version and the longest length field

struct NpyPreamble {
  std::size_t bytes = 0;         // 10 or 12
  std::size_t header_bytes = 0;  // of the dictionary's text, which follows
};

// `start` holds the first bytes of a file: kPreambleBytes of them, or the whole file if it is shorter.
NpyPreamble parse_preamble(std::string_view start, const std::string& file);

// Parses the dictionary, whose keys may come in any order with any spaces between.
NpyHeader parse_header(std::string_view text, const std::string& file);

// Makes the magic number, version 1.0 and the dictionary, padded with spaces so that the data begins at a
// multiple of 64 bytes. `type` is Python's text of it, quotes included.
std::string make_header(std::string_view type, std::span<const std::uint64_t> shape);

// Returns "(3,)" or "(3, 8)"; of more than six sizes the first six.
std::string shape_text(std::span<const std::uint64_t> shape);

}  // namespace kdray::array
