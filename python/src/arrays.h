// What    NumPy's arrays as kdray's views, and kdray's results as NumPy's arrays; neither is copied.
// Shape   python/kdray/_arrays.py has made rows of whatever the user gave: n x N or n, float32 or float64 (or
//         integers), native byte order, values of a row side by side, a stride that is no less than 0 and a
//         multiple of a value; 0: all rows are the first one. None is an empty view.
// Errors  kdray::Error, ErrorCode::internal, for an array that is none of these.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "kdray/arrays.h"

namespace kdray::python {

using In = std::optional<nanobind::ndarray<nanobind::ro, nanobind::device::cpu>>;
using Out = std::optional<nanobind::ndarray<nanobind::device::cpu>>;

Points points_of(const In& array);
Pairs pairs_of(const In& array);
Transforms transforms_of(const In& array);
Values values_of(const In& array);
Triples triples_of(const In& array);
Words words_of(const In& array);
PointsOut points_out(const Out& array);
ValuesOut values_out(const Out& array);
WordsOut words_out(const Out& array);
BytesOut bytes_out(const Out& array);

// A one-dimensional array that owns `values`.
template <class T>
nanobind::ndarray<nanobind::numpy, T> owned(std::vector<T>&& values) {
  auto* const kept = new std::vector<T>(std::move(values));
  nanobind::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nanobind::ndarray<nanobind::numpy, T>(kept->data(), {kept->size()}, owner);
}

// The same with three values to a row.
template <class T>
nanobind::ndarray<nanobind::numpy, T> owned_rows(std::vector<std::array<T, 3>>&& rows) {
  auto* const kept = new std::vector<std::array<T, 3>>(std::move(rows));
  nanobind::capsule owner(kept,
                          [](void* p) noexcept { delete static_cast<std::vector<std::array<T, 3>>*>(p); });
  return nanobind::ndarray<nanobind::numpy, T>(kept->data(), {kept->size(), 3}, owner);
}

}  // namespace kdray::python
