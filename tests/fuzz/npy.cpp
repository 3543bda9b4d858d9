#include "fuzz/target.h"
#include "io/array/rows_file.h"

KDRAY_FUZZ(npy, bytes) {
  using namespace kdray;
  static const fuzz::MemoryFile file;
  file.put(bytes);
  const auto read = [](const array::RowsWanted& wanted, auto row, auto double_row) {
    array::RowsFile rows(file.path(), wanted);
    if (rows.in_double())
      rows.read<decltype(double_row)>();
    else
      rows.read<decltype(row)>();
  };
  const bool rays =
      fuzz::is_read([&] { read(array::kRays, std::array<float, 8>(), std::array<double, 8>()); });
  const bool points =
      fuzz::is_read([&] { read(array::kPoints, std::array<float, 3>(), std::array<double, 3>()); });
  return rays || points;
}
