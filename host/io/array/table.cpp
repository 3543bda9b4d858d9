#include "io/array/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>

#include "base/error.h"
#include "io/array/npy_header.h"
#include "io/array/zip.h"

namespace kdray::array {

namespace {

static_assert(std::endian::native == std::endian::little, "NumPy's '<f4' is written as it lies");

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

// "('point', '<f8', (3,))" of a structured type.
std::string field_of(const Column& c) {
  const std::string shape = c.n_values > 1 ? ", (" + std::to_string(c.n_values) + ",)" : "";
  return "('" + c.name + "', '" + c.type + "'" + shape + ")";
}

std::string header_of(std::span<const Column> columns) {
  const Column& first = columns.front();
  std::vector<std::uint64_t> shape = {first.n_rows};
  if (columns.size() == 1) {
    if (first.n_values > 1) shape.push_back(first.n_values);
    return make_header("'" + first.type + "'", shape);
  }
  std::string type;
  for (const Column& c : columns) type += (type.empty() ? "[" : ", ") + field_of(c);
  return make_header(type + "]", shape);
}

// Returns whether the columns' rows lie in memory just as they do in the file.
bool lie_packed(std::span<const Column> columns, std::size_t record_bytes) {
  std::size_t offset = 0;
  for (const Column& c : columns) {
    if (c.stride != record_bytes || c.first != columns.front().first + offset) return false;
    offset += c.row_bytes();
  }
  return true;
}

// Puts rows [begin, end) of all columns, record by record, to `to`.
void gather(std::span<const Column> columns, std::size_t record_bytes, std::size_t begin, std::size_t end,
            char* to) {
  for (const Column& c : columns) {
    const std::size_t n_bytes = c.row_bytes();
    for (std::size_t i = begin; i < end; ++i)
      std::memcpy(to + (i - begin) * record_bytes, c.first + i * c.stride, n_bytes);
    to += n_bytes;
  }
}

void write_rows(std::span<const Column> columns, const Sink& sink) {
  const std::size_t n_rows = columns.front().n_rows;
  if (n_rows == 0) return;
  std::size_t record_bytes = 0;
  for (const Column& c : columns) record_bytes += c.row_bytes();
  if (lie_packed(columns, record_bytes))
    return sink({reinterpret_cast<const char*>(columns.front().first), n_rows * record_bytes});
  const std::size_t n_at_once = std::max<std::size_t>(1, kPieceBytes / record_bytes);
  std::string piece(std::min(n_rows, n_at_once) * record_bytes, '\0');
  for (std::size_t begin = 0; begin < n_rows; begin += n_at_once) {
    const std::size_t end = std::min(n_rows, begin + n_at_once);
    gather(columns, record_bytes, begin, end, piece.data());
    sink(std::string_view(piece).substr(0, (end - begin) * record_bytes));
  }
}

void check_lengths(std::span<const Column> columns) {
  for (const Column& c : columns)
    if (c.n_rows != columns.front().n_rows)
      throw Error(ErrorCode::internal, "the columns of an .npy or .csv have different lengths");
}

void write_npy(std::span<const Column> columns, const Sink& sink) {
  check_lengths(columns);
  sink(header_of(columns));
  write_rows(columns, sink);
}

// ---- As a text: a line of names, then one for each row, numbers as short as they can be to be read back as
// they are. A column of several values to a row has a name for each: point_x, point_y, point_z.

template <class T>
T value_at(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

void append_value(const Column& c, const std::byte* at, std::string& text) {
  const auto out = std::back_inserter(text);
  if (c.type == kTypeName<float>) {
    fmt::format_to(out, "{}", value_at<float>(at));
  } else if (c.type == kTypeName<double>) {
    fmt::format_to(out, "{}", value_at<double>(at));
  } else if (c.type == kTypeName<std::int32_t>) {
    fmt::format_to(out, "{}", value_at<std::int32_t>(at));
  } else if (c.type == kTypeName<std::uint32_t>) {
    fmt::format_to(out, "{}", value_at<std::uint32_t>(at));
  } else if (c.type == kTypeName<std::uint64_t>) {
    fmt::format_to(out, "{}", value_at<std::uint64_t>(at));
  } else {
    text += *at == std::byte{0} ? '0' : '1';
  }
}

void append_names(std::span<const Column> columns, std::string& text) {
  for (const Column& c : columns)
    for (std::size_t k = 0; k < c.n_values; ++k) {
      text += text.empty() ? "" : ",";
      text += c.n_values > 1 ? fmt::format("{}_{}", c.name, "xyz"[k]) : c.name;
    }
  text += '\n';
}

void write_csv(std::span<const Column> columns, const Sink& sink) {
  check_lengths(columns);
  std::string text;
  append_names(columns, text);
  for (std::size_t row = 0; row < columns.front().n_rows; ++row) {
    for (const Column& c : columns)
      for (std::size_t k = 0; k < c.n_values; ++k) {
        append_value(c, c.first + row * c.stride + k * c.value_bytes, text);
        text += ',';
      }
    text.back() = '\n';
    if (text.size() < kPieceBytes) continue;
    sink(text);
    text.clear();
  }
  if (!text.empty()) sink(text);
}

}  // namespace

Column flags(std::string name, std::span<const std::uint8_t> values) {
  const auto* const first = reinterpret_cast<const std::byte*>(values.data());
  return {std::move(name), "|b1", 1, 1, first, values.size(), 1};
}

void write_table(std::span<const Column> columns, TableFormat format, const Sink& sink) {
  if (format == TableFormat::npy) return write_npy(columns, sink);
  if (format == TableFormat::csv) return write_csv(columns, sink);
  ZipWriter zip(sink);
  for (const Column& c : columns) zip.add(c.name + ".npy", [&](const Sink& to) { write_npy({&c, 1}, to); });
  zip.finish();
}

void write_table(const std::filesystem::path& file, std::span<const Column> columns, TableFormat format) {
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    write_pieces(temporary, file, [&](const Sink& sink) { write_table(columns, format, sink); });
  });
}

}  // namespace kdray::array
