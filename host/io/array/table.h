// What    Named columns of answers, and the files that they are written to: NumPy's .npy and .npz, and .csv.
// Shape   Columns are views of arrays, of structs' fields too, that stay where they are. An .npy holds
//         columns of one length: one of them as a plain array, several as a structured one, packed. An .npz
//         holds any, an array for each. Little endian.
// Errors  kdray::Error, ErrorCode::input: what can't be written. ErrorCode::internal for columns of several
//         lengths in an .npy or a .csv.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "base/write_file.h"

namespace kdray::array {

struct Column {
  std::string name;
  std::string type;             // NumPy's: '<f4'
  std::size_t value_bytes = 0;  // of a value
  std::size_t n_values = 1;     // of a row
  const std::byte* first = nullptr;
  std::size_t n_rows = 0, stride = 0;  // bytes from row to row

  std::size_t row_bytes() const { return n_values * value_bytes; }
};

template <class T>
constexpr const char* kTypeName = nullptr;
template <>
inline constexpr const char* kTypeName<float> = "<f4";
template <>
inline constexpr const char* kTypeName<double> = "<f8";
template <>
inline constexpr const char* kTypeName<std::int32_t> = "<i4";
template <>
inline constexpr const char* kTypeName<std::uint32_t> = "<u4";
template <>
inline constexpr const char* kTypeName<std::uint64_t> = "<u8";

// Returns a column of an array's values, one to a row.
template <class T>
Column column(std::string name, std::span<const T> values) {
  const auto* const first = reinterpret_cast<const std::byte*>(values.data());
  return {std::move(name), kTypeName<T>, sizeof(T), 1, first, values.size(), sizeof(T)};
}
// Returns a column whose rows have several values.
template <class T, std::size_t N>
Column column(std::string name, std::span<const std::array<T, N>> rows) {
  const auto* const first = reinterpret_cast<const std::byte*>(rows.data());
  return {std::move(name), kTypeName<T>, sizeof(T), N, first, rows.size(), sizeof rows[0]};
}
// Returns a column of a field of structs.
template <class Struct, class T>
Column column(std::string name, std::span<const Struct> rows, T Struct::*field) {
  const auto* const first =
      rows.empty() ? nullptr : reinterpret_cast<const std::byte*>(&(rows.front().*field));
  return {std::move(name), kTypeName<T>, sizeof(T), 1, first, rows.size(), sizeof(Struct)};
}
// Returns a column of bytes that are 0 or 1: false and true.
Column flags(std::string name, std::span<const std::uint8_t> values);

enum class TableFormat { npy, npz, csv };

void write_table(std::span<const Column> columns, TableFormat format, const Sink& sink);
// Writes a table to a file, whole or not at all.
void write_table(const std::filesystem::path& file, std::span<const Column> columns, TableFormat format);

}  // namespace kdray::array
