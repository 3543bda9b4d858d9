// What    Rays and points from a file or a pipe (docs/cli.md): rows of a fixed number of values, a NumPy
//         array in float32 or float64, or a text (text_rows.h), in double.
// Shape   Of NumPy's, format versions 1 to 3, little endian, C order, N x the number of values; 0 rows
//         allowed. The header is checked against the file's size before anything is read, so that a caller
//         knows how much there will be; texts and pipes are read whole. Rays may be N x 6: from 0 to
//         infinity.
// Errors  kdray::Error, ErrorCode::input: neither NumPy nor text, wrong type, order or shape, cut short; the
//         message says what was found and what is wanted. The values are not checked here.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace kdray::array {

// What a file should hold, in words for messages.
struct RowsWanted {
  const char* name;  // as in "rays are N x 8"
  std::uint64_t n_values;
  const char* columns;
  std::uint64_t n_short = 0;  // where rows may be shorter: rays without t_min and t_max
};
inline constexpr RowsWanted kRays{
    "rays", 8, "origin x y z, t_min, direction x y z, t_max; without t_min and t_max N x 6", 6};
inline constexpr RowsWanted kPoints{"points", 3, "x y z"};

class RowsFile {
 public:
  // "-": standard input.
  RowsFile(const std::filesystem::path& file, const RowsWanted& wanted);

  std::uint64_t size() const { return n_rows_; }  // rows
  bool in_double() const { return in_double_; }
  std::uint64_t row_bytes() const { return n_values_ * (in_double_ ? sizeof(double) : sizeof(float)); }

  // Returns all of them; a Row is as many floats, or where in_double() doubles, as were wanted.
  template <class Row>
  std::vector<Row> read() {
    std::vector<Row> rows(static_cast<std::size_t>(n_rows_));
    read_into(rows.data(), sizeof(Row));
    return rows;
  }

 private:
  void read_header(const std::string& start, std::uint64_t size, const RowsWanted& wanted);
  void read_text(std::uint64_t size, const RowsWanted& wanted);
  template <class T>
  void lengthen(T* rows) const;
  void seek(std::uint64_t position);
  void read_bytes(void* to, std::size_t n_bytes);
  void read_into(void* rows, std::size_t bytes_of_row);
  [[noreturn]] void cannot_be_read() const;

  std::string name_, kept_;  // what a pipe had
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  std::uint64_t n_values_, n_columns_ = 0, n_rows_ = 0, data_begin_ = 0;
  bool in_double_ = false;
  std::vector<double> text_;  // a text's values
};

}  // namespace kdray::array
