// What    Views of a program's own arrays, by which it hands vertices, indices, rays and points to kdray and
//         gets results back, without a copy of its own: float or double, 32 or 64 bits, whatever lies between
//         two of them.
// Shape   A view is a first element, a number of rows, the bytes from one row to the next and which type the
//         values are of. N values make a row. Rows without a stride lie one after the other; a stride of 0
//         means that all of them are the first one.
// Errors  ErrorCode::input for values that make no whole number of rows, for rows to be written that overlap,
//         for a null pointer, and for rows that reach beyond the memory that was given (a range), or beyond
//         all that there can be (a pointer). Whoever takes a view checks its size and its values.
// Threads A view refers to memory that the caller keeps, and leaves alone, as long as a call lasts.
#pragma once

#if __cplusplus < 202002L
#error "kdray's headers are C++20: compile with -std=c++20 or later"
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

#include "kdray/error.h"

namespace kdray {

template <class T>
inline constexpr bool kIsRowOrValue = std::is_arithmetic_v<T>;
template <class T, std::size_t M>
inline constexpr bool kIsRowOrValue<std::array<T, M>> = std::is_arithmetic_v<T>;

// N values of one of Types to a row. `Types` are const for what is read, plain for what is written.
template <std::size_t N, class... Types>
class Rows {
 public:
  using Any = std::common_type_t<std::remove_const_t<Types>...>;  // that holds each of them
  static constexpr std::size_t kValues = N;

  Rows() = default;

  // clang-format off
  // n rows, one after the other.
  template <class T>
    requires(std::is_same_v<T, Types> || ...) || (std::is_same_v<const T, Types> || ...)
  Rows(T* first, std::size_t n) : Rows(first, n, kBytes<T>) {}

  template <class T>
    requires(std::is_same_v<T, Types> || ...) || (std::is_same_v<const T, Types> || ...)
  Rows(T* first, std::size_t n, std::size_t stride_bytes)
      : first_(as_held(first)), n_(n), stride_(stride_bytes) {
    if (n == 0) return;
    if (first == nullptr) refuse<T>("have no memory: their pointer is null");
    if (is_beyond<T>(PTRDIFF_MAX)) refuse<T>("reach beyond any memory");
    if ((!std::is_const_v<Types> && ...) && n > 1 && stride_ < kBytes<T>)
      refuse<T>("are to be written and overlap");
  }

  // n rows of N values, one after the other (numbers, or a std::array for each row); or n values where N is
  // 1. A view of a temporary is for the call that it is made in.
  template <std::ranges::contiguous_range Range>
    requires kIsRowOrValue<std::ranges::range_value_t<Range>>
  Rows(Range&& range) : Rows(of_range(std::data(range), std::size(range))) {}
  // clang-format on

  // n rows that lie within this memory, the first at its begin.
  template <class T>
  Rows(std::span<T> memory, std::size_t n, std::size_t stride_bytes) : Rows(memory.data(), n, stride_bytes) {
    if (n > 0 && is_beyond<T>(memory.size_bytes()))
      refuse<T>("reach beyond the " + std::to_string(memory.size_bytes()) + " bytes that there are");
  }

  std::size_t size() const { return n_; }
  bool empty() const { return n_ == 0; }
  std::size_t stride() const { return stride_; }

  // The values of row i, as they are in memory.
  std::array<Any, N> operator[](std::size_t i) const {
    return std::visit(
        [&](auto* first) {
          std::array<Any, N> row;
          for (std::size_t k = 0; k < N; ++k) row[k] = static_cast<Any>(value_at(first, i, k));
          return row;
        },
        first_);
  }

  // Writes row_of(i), an array of N values, for rows first to first + n.
  template <class RowOf>
  void fill(std::size_t first, std::size_t n, const RowOf& row_of) const
      requires(!std::is_const_v<Types> && ...) {
    std::visit(
        [&](auto* begin) {
          using T = std::remove_pointer_t<decltype(begin)>;
          for (std::size_t i = first; i < first + n; ++i) {
            const auto row = row_of(i);
            for (std::size_t k = 0; k < N; ++k) {
              const T value = static_cast<T>(row[k]);
              std::memcpy(at(begin, i, k), &value, sizeof value);
            }
          }
        },
        first_);
  }

  // Where the rows of that very type begin; null where they are of another.
  template <class T>
  T* first_of() const {
    T* const* const first = std::get_if<T*>(&first_);
    return first ? *first : nullptr;
  }

 private:
  template <class T>
  static constexpr std::size_t kBytes = N * sizeof(T);  // of a row

  // Whether the last row ends beyond so many bytes; there are rows.
  template <class T>
  bool is_beyond(std::size_t bytes) const {
    return bytes < kBytes<T> || (n_ > 1 && stride_ > (bytes - kBytes<T>) / (n_ - 1));
  }
  template <class T>
  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::input, std::to_string(n_) + " rows of " + std::to_string(kBytes<T>) + " bytes, " +
                                      std::to_string(stride_) + " bytes apart, " + why);
  }

  template <class T>
  static auto as_held(T* first) {
    if constexpr ((std::is_same_v<T, Types> || ...))
      return first;
    else
      return static_cast<const T*>(first);
  }
  template <class T, std::size_t M>
  static Rows of_range(std::array<T, M>* rows, std::size_t n) {
    static_assert(M == N, "the rows have another number of values");
    return n == 0 ? Rows() : Rows(rows->data(), n);
  }
  template <class T, std::size_t M>
  static Rows of_range(const std::array<T, M>* rows, std::size_t n) {
    static_assert(M == N, "the rows have another number of values");
    return n == 0 ? Rows() : Rows(rows->data(), n);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  static Rows of_range(T* values, std::size_t n) {
    if (n % N != 0)
      throw Error(ErrorCode::input, "an array of " + std::to_string(n) +
                                        " values is no whole number of rows of " + std::to_string(N));
    return Rows(values, n / N);
  }

  template <class T>
  T* at(T* first, std::size_t i, std::size_t k) const {
    using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
    return reinterpret_cast<T*>(reinterpret_cast<Byte*>(first) + i * stride_) + k;
  }
  // By memcpy: a stride may leave values where their type is not aligned.
  template <class T>
  std::remove_const_t<T> value_at(T* first, std::size_t i, std::size_t k) const {
    std::remove_const_t<T> value;
    std::memcpy(&value, at(first, i, k), sizeof value);
    return value;
  }

  std::variant<Types*...> first_;
  std::size_t n_ = 0, stride_ = 0;
};

using Points = Rows<3, const float, const double>;
using Transforms = Rows<12, const float, const double>;  // 3 x 4, row by row
using Pairs = Rows<2, const float, const double>;
using Values = Rows<1, const float, const double>;
using Triples = Rows<3, const std::uint32_t, const std::int32_t, const std::uint64_t, const std::int64_t>;
using Words = Rows<1, const std::uint32_t>;

// What results are written to; empty: not wanted.
using PointsOut = Rows<3, float, double>;
using ValuesOut = Rows<1, float, double>;
using WordsOut = Rows<1, std::uint32_t>;
using BytesOut = Rows<1, std::uint8_t>;

}  // namespace kdray
