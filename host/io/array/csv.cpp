#include "io/array/csv.h"

#include <fmt/format.h>

#include <cstring>
#include <iterator>

namespace kdray::array {

namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;

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

}  // namespace

void write_csv(std::span<const Column> columns, const Sink& sink) {
  std::string text;
  append_names(columns, text);
  for (std::size_t row = 0; row < columns.front().n_rows; ++row) {
    for (const Column& c : columns)
      for (std::size_t k = 0; k < c.n_values; ++k) {
        append_value(c, c.first + row * c.stride + k * c.value_bytes, text);
        text += ',';
      }
    text.back() = '\n';
    if (text.size() < kPiece) continue;
    sink(text);
    text.clear();
  }
  if (!text.empty()) sink(text);
}

}  // namespace kdray::array
