#include "device/opencl/simd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace kdray::device {

namespace {

using layout::SimdAnswers;
using layout::SimdCase;
using layout::u32;

float as_float(u32 bits) {
  return std::bit_cast<float>(bits);
}
u32 as_bits(float value) {
  return std::bit_cast<u32>(value);
}

// The mask of the lanes below n for which `is(lane)` holds.
template <class Is>
u32 mask_where(u32 n, Is&& is) {
  u32 mask = 0;
  for (u32 i = 0; i < n; ++i) mask |= (is(i) ? 1u : 0u) << i;
  return mask;
}

template <std::size_t N, class Lane>
void fill(u32 (&out)[N], Lane&& lane) {
  for (u32 i = 0; i < N; ++i) out[i] = lane(i);
}

// The lanes of `v` that the mask has, packed; 0 behind them.
template <std::size_t N>
void pack(u32 (&out)[N], u32 mask, const u32* v) {
  fill(out, [](u32) { return 0u; });
  for (u32 i = 0, n = 0; i < N; ++i)
    if (mask >> i & 1u) out[n++] = v[i];
}

float number_or_zero(u32 bits) {
  return std::isnan(as_float(bits)) ? 0.0f : as_float(bits);
}

void expect_masks(const SimdCase& c, SimdAnswers& out) {
  const auto less = [&](u32 i) { return as_float(c.a[i]) < as_float(c.b[i]); };
  const auto less_equal = [&](u32 i) { return as_float(c.a[i]) <= as_float(c.b[i]); };
  const auto equal = [&](u32 i) { return as_float(c.a[i]) == as_float(c.b[i]); };
  out.less16 = mask_where(16, less);
  out.less8 = mask_where(8, less);
  out.less4 = mask_where(4, less);
  out.less_equal16 = mask_where(16, less_equal);
  out.less_equal8 = mask_where(8, less_equal);
  out.less_equal4 = mask_where(4, less_equal);
  out.equal16 = mask_where(16, equal);
  out.equal8 = mask_where(8, equal);
  out.equalu16 = mask_where(16, [&](u32 i) { return c.a[i] == c.b[i]; });
  out.negative16 = mask_where(16, [&](u32 i) { return c.a[i] >> 31 != 0; });
}

void expect_vectors(const SimdCase& c, SimdAnswers& out) {
  fill(out.select16, [&](u32 i) { return c.mask >> i & 1u ? c.a[i] : c.b[i]; });
  fill(out.gather16, [&](u32 i) { return c.b[c.index[i] & 15u]; });
  fill(out.permute8, [&](u32 i) { return c.a[c.index[i] & 7u]; });
  pack(out.pack16, c.mask, c.a);
  pack(out.pack8, c.mask, c.a);
  std::ranges::copy(out.select16, out.selectu16);
  std::ranges::copy(out.gather16, out.gatheru16);
  std::ranges::copy(out.permute8, out.permuteu8);
  std::ranges::copy(out.pack8, out.packu8);
  for (u32 i = 0; i < 16; ++i) {
    const float v = as_float(c.a[i]);
    out.nearest_long16[i] = std::abs(v) < 0x1p62f ? static_cast<layout::i64>(std::nearbyint(v)) : 0;
  }
}

struct Field {
  const char* name;
  std::size_t offset, size;
};

#define FIELD(name)                                                               \
  Field {                                                                         \
#name, offsetof(SimdAnswers, name), sizeof(std::declval <SimdAnswers>().name) \
  }
constexpr std::array kFields = {
    FIELD(lanes_below), FIELD(count_lanes), FIELD(first_lane),  FIELD(less16),     FIELD(less_equal16),
    FIELD(equal16),     FIELD(equalu16),    FIELD(negative16),  FIELD(less8),      FIELD(less_equal8),
    FIELD(equal8),      FIELD(less4),       FIELD(less_equal4), FIELD(smallest16), FIELD(largest16),
    FIELD(select16),    FIELD(selectu16),   FIELD(pack16),      FIELD(gather16),   FIELD(gatheru16),
    FIELD(pack8),       FIELD(packu8),      FIELD(permute8),    FIELD(permuteu8),  FIELD(nearest_long16)};
#undef FIELD

const void* at(const SimdAnswers& answers, const Field& field) {
  return reinterpret_cast<const char*>(&answers) + field.offset;
}

// Subnormal numbers are left out: a device may take them for 0.
constexpr std::array kHardValues = {
    0x00000000u,  // 0
    0x80000000u,  // -0
    0x7fc00000u,  // NaN
    0xffc12345u,  // NaN with a sign and a payload
    0x7f800000u,  // infinity
    0xff800000u,  // -infinity
    0x7f7fffffu,  // the largest number
    0xff7fffffu,  // its negative
    0x00800000u,  // the smallest normal number
    0x80800000u,  // its negative
    0x3f800000u,  // 1
    0xbf800000u,  // -1
    0x3f800001u,  // the next number above 1
    0x3f7fffffu,  // the next below 1
    0x4b800001u,  // above 2^24
    0xc0200000u   // -2.5, as near to -3 as to -2
};

u32 reversed_byte(u32 byte) {
  u32 reversed = 0;
  for (u32 i = 0; i < 8; ++i) reversed |= (byte >> i & 1u) << (7 - i);
  return reversed;
}

}  // namespace

SimdAnswers expected_answers(const SimdCase& c) {
  SimdAnswers out{};
  const u32 n_below = c.index[0] & 63u;
  out.lanes_below = n_below >= 32 ? ~0u : (1u << n_below) - 1u;
  out.count_lanes = static_cast<u32>(std::popcount(c.mask));
  out.first_lane = static_cast<u32>(std::countr_zero(c.mask | 0x10000u));
  expect_masks(c, out);
  expect_vectors(c, out);
  float smallest = std::numeric_limits<float>::infinity(), largest = -smallest;
  for (const u32 bits : c.a) {
    smallest = std::min(smallest, number_or_zero(bits));
    largest = std::max(largest, number_or_zero(bits));
  }
  out.smallest16 = as_bits(smallest + 0.0f);
  out.largest16 = as_bits(largest + 0.0f);
  return out;
}

std::vector<SimdCase> known_cases() {
  constexpr u32 kN = kHardValues.size();
  static_assert(kN == 16);
  std::vector<SimdCase> cases(kN * kN);
  for (u32 k = 0; k < cases.size(); ++k) {
    SimdCase& c = cases[k];
    c.mask = k | reversed_byte(k) << 8;
    for (u32 i = 0; i < 16; ++i) {
      c.a[i] = kHardValues[(i + k) % kN];
      c.b[i] = kHardValues[(i + k / kN) % kN];
      c.index[i] = k * 7 + i * (2 * k + 1) + (i << 28);
    }
  }
  return cases;
}

std::string first_difference(const std::vector<SimdCase>& cases, const std::vector<SimdAnswers>& answers) {
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const SimdAnswers wanted = expected_answers(cases[k]);
    for (const Field& field : kFields)
      if (std::memcmp(at(wanted, field), at(answers.at(k), field), field.size) != 0)
        return fmt::format("{} of case {}", field.name, k);
  }
  return "";
}

}  // namespace kdray::device
