// What    NumPy's files by hand, for the command line's tests: .npy written and read, .npz read.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace kdray::test {

// NumPy format 1.0: magic, version, the header's length, a dictionary padded to 64 bytes, the data.
inline std::string npy(const std::string& dictionary, const std::string& data) {
  std::string header = dictionary;
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 255);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header + data;
}

template <class T, std::size_t N>
std::string npy_of(const std::string& type, const std::vector<std::array<T, N>>& rows) {
  std::string data(rows.size() * sizeof(std::array<T, N>), '\0');
  if (!rows.empty()) std::memcpy(data.data(), rows.data(), data.size());
  return npy("{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + std::to_string(rows.size()) +
                 ", " + std::to_string(N) + "), }",
             data);
}

// What an .npy holds, whose header has `header` in it: its type and shape.
template <class T>
std::vector<T> values_of(const std::string& bytes, const std::string& header) {
  if (bytes.size() < 10) throw std::runtime_error("no .npy");
  const std::size_t begin =
      10 + static_cast<unsigned char>(bytes[8]) + 256 * static_cast<unsigned char>(bytes[9]);
  if (bytes.substr(0, begin).find(header) == std::string::npos)
    throw std::runtime_error("no " + header + " in " + bytes.substr(10, begin - 10));
  std::vector<T> values((bytes.size() - begin) / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data() + begin, values.size() * sizeof(T));
  return values;
}

// The files of an archive, which are stored as they are, by their names without .npy.
inline std::map<std::string, std::string> files_of_npz(const std::string& bytes) {
  const auto word = [&](std::size_t at, std::size_t n) {
    std::size_t value = 0;
    for (std::size_t i = n; i-- > 0;) value = 256 * value + static_cast<unsigned char>(bytes.at(at + i));
    return value;
  };
  std::map<std::string, std::string> files;
  std::size_t at = 0;
  while (bytes.substr(at, 4) == "PK\3\4") {
    const std::size_t size = word(at + 22, 4), name = word(at + 26, 2), extra = word(at + 28, 2);
    files[bytes.substr(at + 30, name - 4)] = bytes.substr(at + 30 + name + extra, size);
    at += 30 + name + extra + size;
  }
  return files;
}

}  // namespace kdray::test
