#include "io/array/rows_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "io/array/npy_header.h"
#include "io/array/text_rows.h"

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

bool fits(std::uint64_t n_columns, const RowsWanted& wanted) {
  return n_columns == wanted.n_values || (n_columns > 0 && n_columns == wanted.n_short);
}

std::uint64_t check_shape(const NpyHeader& header, const RowsWanted& wanted, const std::string& file) {
  if (header.shape.size() != 2 || !fits(header.shape[1], wanted))
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

// Returns all that a pipe has.
std::string drain(std::FILE* pipe, const std::string& name) {
  std::string all;
  std::array<char, 1 << 16> piece;
  while (const std::size_t n = std::fread(piece.data(), 1, piece.size(), pipe)) all.append(piece.data(), n);
  if (std::ferror(pipe)) throw input_error(name, 0, std::string("cannot be read: ") + std::strerror(errno));
  return all;
}

std::FILE* opened(const fs::path& path) {
  std::FILE* const stream = std::fopen(path.c_str(), "rb");
  if (stream == nullptr)
    throw input_error(path.string(), 0, std::string("cannot be opened: ") + std::strerror(errno),
                      "check its name");
  return stream;
}

// A stream that can go back; `kept` gets what a pipe has.
std::FILE* open(const fs::path& path, const RowsWanted& wanted, std::string& kept) {
  const std::string name = path.string();
  const bool is_stdin = name == "-";
  std::error_code error;
  const fs::file_status status = fs::status(is_stdin ? "/dev/stdin" : path, error);
  if (fs::is_directory(status)) throw input_error(name, 0, "is a folder", "name a .npy file in it");
  if (is_stdin || fs::is_fifo(status)) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(opened(is_stdin ? "/dev/stdin" : path),
                                                               std::fclose);
    kept = drain(pipe.get(), name);
    if (kept.empty()) throw input_error(name, 0, "is empty", std::string("give it the ") + wanted.name);
    return ::fmemopen(kept.data(), kept.size(), "rb");
  }
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw input_error(name, 0, "is no regular file",
                      std::string("save the ") + wanted.name + " to a file first");
  std::FILE* const stream = opened(path);
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
    : name_(path.string()), stream_(open(path, wanted, kept_), std::fclose), n_values_(wanted.n_values) {
  if (!stream_) throw Error(ErrorCode::out_of_memory, name_ + ": out of memory for a pipe's bytes");
  const std::uint64_t size = kept_.empty() ? size_of(path) : kept_.size();
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(kPreambleBytes, size)), '\0');
  read_bytes(start.data(), start.size());
  if (size == 0) throw input_error(name_, 0, "is empty", std::string("put the ") + wanted.name + " into it");
  looks_like_text(start) ? read_text(size, wanted) : read_header(start, size, wanted);
}

void RowsFile::read_text(std::uint64_t size, const RowsWanted& wanted) {
  if (kept_.empty()) {
    kept_.resize(static_cast<std::size_t>(size));
    seek(0);
    read_bytes(kept_.data(), kept_.size());
  }
  if (!looks_like_text(kept_)) throw input_error(name_, 0, "is neither a NumPy file nor a text");
  TextRows rows = read_text_rows(kept_, name_);
  kept_ = {};
  n_columns_ = rows.n_columns;
  if (n_columns_ == 0) throw input_error(name_, 0, "has no line of numbers");
  if (!fits(n_columns_, wanted))
    throw input_error(name_, 0,
                      "has " + std::to_string(n_columns_) + " to a line but " + wanted.name + " have " +
                          std::to_string(wanted.n_values),
                      std::string("columns are ") + wanted.columns);
  text_ = std::move(rows.values);
  n_rows_ = text_.size() / n_columns_;
  in_double_ = true;
}

void RowsFile::read_header(const std::string& start, std::uint64_t size, const RowsWanted& wanted) {
  const NpyPreamble preamble = parse_preamble(start, name_);
  data_begin_ = std::uint64_t{preamble.bytes} + preamble.header_bytes;
  if (data_begin_ > size) throw input_error(name_, 0, "is cut short in its header", "save it again");
  std::string text(preamble.header_bytes, '\0');
  seek(preamble.bytes);
  read_bytes(text.data(), text.size());
  const NpyHeader header = parse_header(text, name_);
  in_double_ = check_type(header, wanted, name_);
  n_rows_ = check_shape(header, wanted, name_);
  n_columns_ = header.shape[1];
  check_bytes(n_rows_, row_bytes() / n_values_ * n_columns_, size - data_begin_, wanted, name_);
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
  const std::size_t value_bytes = in_double_ ? sizeof(double) : sizeof(float);
  if (!text_.empty()) {
    std::memcpy(rows, text_.data(), text_.size() * sizeof(double));
    text_ = {};
  } else {
    seek(data_begin_);
    read_bytes(rows, static_cast<std::size_t>(n_rows_ * n_columns_ * value_bytes));
  }
  if (n_columns_ == n_values_) return;
  in_double_ ? lengthen(static_cast<double*>(rows)) : lengthen(static_cast<float*>(rows));
}

// Makes rays of origins and directions, which lie at the front, from the last one on.
template <class T>
void RowsFile::lengthen(T* rows) const {
  for (std::size_t i = n_rows_; i-- > 0;) {
    const T *const from = rows + 6 * i,
                   ray[8] = {from[0], from[1], from[2], 0,
                             from[3], from[4], from[5], std::numeric_limits<T>::infinity()};
    std::copy_n(ray, 8, rows + 8 * i);
  }
}

void RowsFile::cannot_be_read() const {
  throw input_error(name_, 0, "cannot be read to its end", "check the disk, or save it again");
}

}  // namespace kdray::array
