#include "io/array/rows_file.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "io/array/npy_header.h"

namespace kdray::array {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "NumPy's '<f4' is read as it lies");

// Returns whether the values are doubles. The remedies are the Python that a user would type.
bool check_type(const NpyHeader& header, const RowsWanted& wanted, const std::string& file) {
  const std::string name = wanted.name;
  if (header.structured)
    throw input_error(
        file, 0,
        "holds records " + header.type.substr(0, 80) + " but " + name +
            " are plain float32 or float64, N x " + std::to_string(wanted.n_values),
        "numpy.lib.recfunctions.structured_to_unstructured(" + name + ", dtype='<f4') makes them so");
  if (header.type == "<f4" || header.type == "<f8") return header.type == "<f8";
  throw input_error(file, 0,
                    "holds the type '" + header.type.substr(0, 40) + "' but " + name +
                        " are float32 ('<f4') or float64 ('<f8')",
                    "save " + name + (header.type.ends_with("f8") ? ".astype('<f8')" : ".astype('<f4')"));
}

std::uint64_t check_shape(const NpyHeader& header, const RowsWanted& wanted, const std::string& file) {
  if (header.shape.size() != 2 || header.shape[1] != wanted.n_values)
    throw input_error(file, 0,
                      "has the shape " + shape_text(header.shape) + " but " + wanted.name + " are N x " +
                          std::to_string(wanted.n_values),
                      std::string("columns are ") + wanted.columns);
  // One row, or none, lies the same way in both orders.
  if (header.fortran_order && header.shape[0] > 1)
    throw input_error(file, 0, "is in Fortran order (column by column)",
                      std::string("save numpy.ascontiguousarray(") + wanted.name + ")");
  return header.shape[0];
}

std::FILE* open(const fs::path& path, const RowsWanted& wanted) {
  const std::string name = path.string();
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::is_directory(status)) throw input_error(name, 0, "is a folder", "name a .npy file in it");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw input_error(name, 0, "is no regular file",
                      std::string("save the ") + wanted.name + " to a file first");
  std::FILE* const stream = std::fopen(path.c_str(), "rb");
  if (stream == nullptr)
    throw input_error(name, 0, std::string("cannot be opened: ") + std::strerror(errno), "check its name");
  // The rows go straight into their vector; a buffer between would only copy them.
  std::setvbuf(stream, nullptr, _IONBF, 0);
  return stream;
}

std::uint64_t size_of(const fs::path& path) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) throw input_error(path.string(), 0, "cannot be read: " + error.message());
  return size;
}

void check_bytes(std::uint64_t n_rows, std::uint64_t row_bytes, std::uint64_t data_bytes,
                 const RowsWanted& wanted, const std::string& file) {
  if (n_rows == data_bytes / row_bytes && data_bytes % row_bytes == 0) return;
  throw input_error(
      file, 0,
      "has " + std::to_string(data_bytes) + " bytes of data but " + std::to_string(n_rows) + " " +
          wanted.name + " of " + std::to_string(row_bytes) + " bytes are announced",
      n_rows > data_bytes / row_bytes ? "it was cut short: save it again" : "save one array to a file");
}

}  // namespace

RowsFile::RowsFile(const fs::path& path, const RowsWanted& wanted)
    : name_(path.string()), stream_(open(path, wanted), std::fclose), n_values_(wanted.n_values) {
  const std::uint64_t size = size_of(path);
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(kPreambleBytes, size)), '\0');
  read_bytes(start.data(), start.size());
  const NpyPreamble preamble = parse_preamble(start, name_);
  data_begin_ = std::uint64_t{preamble.bytes} + preamble.header_bytes;
  if (data_begin_ > size) throw input_error(name_, 0, "is cut short in its header", "save it again");
  std::string text(preamble.header_bytes, '\0');
  seek(preamble.bytes);
  read_bytes(text.data(), text.size());
  const NpyHeader header = parse_header(text, name_);
  in_double_ = check_type(header, wanted, name_);
  n_rows_ = check_shape(header, wanted, name_);
  check_bytes(n_rows_, row_bytes(), size - data_begin_, wanted, name_);
}

void RowsFile::seek(std::uint64_t position) {
  if (std::fseek(stream_.get(), static_cast<long>(position), SEEK_SET) != 0) cannot_be_read();
}

void RowsFile::read_bytes(void* to, std::size_t n_bytes) {
  if (n_bytes > 0 && std::fread(to, 1, n_bytes, stream_.get()) != n_bytes) cannot_be_read();
}

void RowsFile::read_into(void* rows, std::size_t bytes_of_row) {
  if (bytes_of_row != row_bytes())
    throw Error(ErrorCode::internal, name_ + ": its rows are read as rows of another size");
  seek(data_begin_);
  read_bytes(rows, static_cast<std::size_t>(n_rows_ * row_bytes()));
}

void RowsFile::cannot_be_read() const {
  throw input_error(name_, 0, "cannot be read to its end", "check the disk, or save it again");
}

}  // namespace kdray::array
