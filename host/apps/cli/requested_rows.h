// What    The rays or points that kdray trace asks about, as their file has them: float or double.
// Shape   Views of them, as the API takes them (kdray/query.h).
// Errors  kdray::Error: the file's own (io/array/rows_file.h); ErrorCode::out_of_memory where they and their
//         answers don't fit.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "apps/cli/question.h"
#include "kdray/query.h"

namespace kdray::cli {

class RequestedRows {
 public:
  // Reads all of the file. `free`: bytes of memory.
  RequestedRows(array::RowsFile& file, const TraceRequest& request, std::uint64_t free);

  std::size_t size() const;
  // Views of the first n.
  Rays rays(std::size_t n) const;
  Points points(std::size_t n) const;
  // All of them, where they are rays of floats.
  std::span<const Ray> structs() const { return std::get<std::vector<Ray>>(rows_); }

 private:
  template <class T, std::size_t N>
  using Rows = std::vector<std::array<T, N>>;
  std::variant<std::vector<Ray>, Rows<double, 8>, Rows<float, 3>, Rows<double, 3>> rows_;
};

}  // namespace kdray::cli
