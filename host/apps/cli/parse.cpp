#include "apps/cli/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

// The whole of `text` as a number: "1e3 " or "5x" are none, and neither are "inf" and "nan".
template <class T>
bool whole_number(std::string_view text, T& value) {
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return false;
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
  return true;
}

bool is_one_of(std::string_view text, std::span<const std::string_view> accepted) {
  return std::find(accepted.begin(), accepted.end(), text) != accepted.end();
}

}  // namespace

Error usage_error(std::string_view option, std::string_view given, std::string_view wanted) {
  return Error(ErrorCode::usage, fmt::format("{} '{}': expected {}", option, given, wanted));
}

int parse_int(std::string_view option, std::string_view text, int lo, int hi) {
  int value = 0;
  if (!whole_number(text, value) || value < lo || value > hi)
    throw usage_error(option, text, fmt::format("a whole number from {} to {}", lo, hi));
  return value;
}

double parse_real(std::string_view option, std::string_view text, double lo, double hi) {
  double value = 0;
  if (!whole_number(text, value) || value < lo || value > hi)
    throw usage_error(option, text, fmt::format("a number from {} to {}", lo, hi));
  return value;
}

std::vector<double> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    double value = 0;
    if (!whole_number(text.substr(start, comma - start), value)) return {};
    numbers.push_back(value);
    start = comma + 1;
  }
  return numbers;
}

// The number is exact where it is whole; a fraction is rounded down to a byte.
std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::string_view kUnits = "KMGT", kLowerUnits = "kmgt";
  constexpr std::string_view kWanted = "a number of bytes, as in 4096, 64K, 500M, 1.5G or 1T";
  constexpr double kTooMany = 18446744073709551616.0;  // 2^64
  const auto unit = text.empty() ? std::string_view::npos
                                 : std::min(kUnits.find(text.back()), kLowerUnits.find(text.back()));
  const bool has_unit = unit != std::string_view::npos;
  const unsigned shift = has_unit ? 10 * (static_cast<unsigned>(unit) + 1) : 0;
  const std::string_view number = text.substr(0, text.size() - (has_unit ? 1 : 0));
  if (number.empty() || number.find_first_not_of("0123456789.") != std::string_view::npos)
    throw usage_error(option, text, kWanted);
  std::uint64_t whole = 0;
  if (whole_number(number, whole) && whole <= std::numeric_limits<std::uint64_t>::max() >> shift)
    return whole << shift;
  double value = 0;
  if (!whole_number(number, value)) throw usage_error(option, text, kWanted);
  value = std::ldexp(value, static_cast<int>(shift));
  if (value >= kTooMany) throw usage_error(option, text, "less than 2^64 bytes, as in 500M, 1.5G or 1T");
  return static_cast<std::uint64_t>(value);
}

Size parse_size(std::string_view option, std::string_view text, int side_max, long long pixels_max) {
  Size size;
  const std::size_t cross = text.find_first_of("xX");
  const bool good = cross != std::string_view::npos && whole_number(text.substr(0, cross), size.width) &&
                    whole_number(text.substr(cross + 1), size.height) && size.width >= 1 &&
                    size.height >= 1 && size.width <= side_max && size.height <= side_max;
  if (!good) throw usage_error(option, text, fmt::format("WIDTHxHEIGHT, each from 1 to {}", side_max));
  if (static_cast<long long>(size.width) * size.height > pixels_max)
    throw usage_error(option, text, fmt::format("no more than {} pixels in all", pixels_max));
  return size;
}

Samples parse_samples(std::string_view option, std::string_view text) {
  constexpr std::string_view kAdaptive = "adaptive";
  constexpr int kMost = 65536;
  constexpr double kLeast = 1e-6, kLargest = 1e6;
  Samples samples;
  if (text == kAdaptive) return {0, kDefaultAdaptiveTarget};
  if (text.starts_with("adaptive:") && whole_number(text.substr(kAdaptive.size() + 1), samples.target) &&
      samples.target >= kLeast && samples.target <= kLargest)
    return samples;
  if (whole_number(text, samples.number) && samples.number >= 1 && samples.number <= kMost)
    return {samples.number, 0};
  throw usage_error(
      option, text,
      fmt::format("a whole number from 1 to {}, adaptive, or adaptive:TARGET with an RMSE of {} or more",
                  kMost, kLeast));
}

image::Transfer parse_gamma(std::string_view option, std::string_view text) {
  if (text == "srgb") return {};
  double gamma = 0;
  if (!whole_number(text, gamma) || gamma < 0.1 || gamma > 10)
    throw usage_error(option, text, "srgb or a number from 0.1 to 10");
  return {.srgb = false, .gamma = gamma};
}

std::string parse_choice(std::string_view option, std::string_view text,
                         std::span<const std::string_view> accepted) {
  if (!is_one_of(text, accepted))
    throw usage_error(option, text,
                      fmt::format("{}{}", accepted.size() > 1 ? "one of " : "", fmt::join(accepted, ", ")));
  return std::string(text);
}

std::vector<std::string> parse_list(std::string_view option, std::string_view text,
                                    std::span<const std::string_view> accepted) {
  std::vector<std::string> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string name(text.substr(start, comma - start));
    if (!is_one_of(name, accepted))
      throw usage_error(option, text,
                        fmt::format("names from {}, with commas between", fmt::join(accepted, ", ")));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    start = comma + 1;
  }
  return names;
}

}  // namespace kdray::cli
