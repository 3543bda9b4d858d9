// What    Reads the numbers that files are full of, such as -0.0125 or 871414, in one pass and without a
//         call; whatever is longer, larger or odd is left to std::from_chars.
// Shape   Each function returns where the number ends, or nullptr for "not a plain one: ask from_chars"; the
//         value is then untouched. The caller looks at what follows the number.
// Why     A scanner that first looks for a token's end and then parses it sees each digit twice, and pays two
//         calls.
// Source  W. D. Clinger, "How to read floating point numbers accurately", 1990: digits below 2^53 and a power
//         of ten up to 10^22 are doubles both, so that one division or product of them is the correctly
//         rounded value.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace kdray::scene {

// Reads the digits at `p`, behind those in `value` already. They wrap around when there are more than 19.
inline const char* take_digits(const char* p, const char* end, std::uint64_t& value) {
  for (; p != end; ++p) {
    const auto digit = static_cast<unsigned>(static_cast<unsigned char>(*p)) - '0';
    if (digit > 9) break;
    value = value * 10 + digit;
  }
  return p;
}

// Reads a whole number without a sign.
inline const char* read_plain_whole(const char* p, const char* end, std::int64_t& value) {
  constexpr std::ptrdiff_t kMostDigits = 18;  // below 2^63
  std::uint64_t digits = 0;
  const char* const stop = take_digits(p, end, digits);
  if (stop == p || stop - p > kMostDigits) return nullptr;
  value = static_cast<std::int64_t>(digits);
  return stop;
}

// Reads a decimal number without an exponent.
inline const char* read_plain_number(const char* p, const char* end, double& value) {
  constexpr std::array<double, 23> kPowers = {1,    1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::ptrdiff_t kMostDigits = 19;  // below 2^64
  const bool negative = p != end && *p == '-';
  if (negative) ++p;
  std::uint64_t digits = 0;
  const char* const first = p;
  p = take_digits(p, end, digits);
  std::ptrdiff_t count = p - first;
  std::ptrdiff_t places = 0;
  if (p != end && *p == '.') {
    const char* const point = p;
    p = take_digits(p + 1, end, digits);
    places = p - point - 1;
    if (places == 0) return nullptr;
    count += places;
  }
  const bool exponent = p != end && (*p == 'e' || *p == 'E');
  if (count == 0 || count > kMostDigits || digits > std::uint64_t{1} << 53 || exponent) return nullptr;
  const double magnitude = static_cast<double>(digits) / kPowers[static_cast<std::size_t>(places)];
  value = negative ? -magnitude : magnitude;
  return p;
}

}  // namespace kdray::scene
