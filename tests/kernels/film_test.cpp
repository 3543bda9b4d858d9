// What a kernel adds to the film, against sums in 128 bits: rounding, lanes that share a pixel, lanes that
// have none, colours that are no numbers, and sums at their ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "device/opencl/simd.h"
#include "layout/frame.layout.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

constexpr int kPixels = 6;
constexpr cl_uint kFirst = 1000;  // the film begins with this pixel

// Sixteen lanes with two contributions each, and the film before.
struct Case {
  cl_float light[2][3][16];
  cl_uint in[2][16], pixel[16];
  cl_long film[kPixels][3];
};
struct Result {
  cl_long film[kPixels][3];
  cl_long n_nan;
};

constexpr const char* kSource = R"(#include "film/accumulate.clh"
typedef struct Case { float light[2][3][16]; uint in[2][16]; uint pixel[16]; long film[6][3]; } Case;
typedef struct Result { long film[6][3]; long n_nan; } Result;
__constant Frame frame = {.first_pixel = 1000};
__kernel void test(__global const Case* in, __global Result* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  for (int k = 0; k < 18; ++k) out[i].film[k / 3][k % 3] = in[i].film[k / 3][k % 3];
  FilmLight sum = no_light();
  for (int k = 0; k < 2; ++k) {
    const Real3xN light = {convert_real16(vload16(0, in[i].light[k][0])),
                            convert_real16(vload16(0, in[i].light[k][1])),
                            convert_real16(vload16(0, in[i].light[k][2]))};
    add_light(&sum, convert_lanes16(vload16(0, in[i].in[k]) != 0), light);
  }
  add_to_film(&frame, (__global i64*)out[i].film, convert_word16(vload16(0, in[i].pixel)), &sum);
  out[i].n_nan = sum.n_nan;
}
)";

float some_light(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  switch (random() % 10) {
    case 0:
      return 0;
    case 1:
      return std::numeric_limits<float>::quiet_NaN();
    case 2:
      return std::numeric_limits<float>::infinity();
    case 3:
      return 1e30f;
    case 4:
      return (static_cast<float>(random() % 1000) + 0.5f) / KDRAY_FILM_SCALE;  // half a unit
    default:
      return std::ldexp(unit(random), static_cast<int>(random() % 60) - 40);
  }
}

Case some_case(std::mt19937& random) {
  Case c{};
  for (int k = 0; k < 2; ++k)
    for (int lane = 0; lane < 16; ++lane) {
      for (auto& channel : c.light[k]) channel[lane] = some_light(random);
      c.in[k][lane] = random() % 3 > 0;
    }
  for (int lane = 0; lane < 16; ++lane)  // of lanes without light anything may be said
    c.pixel[lane] =
        c.in[0][lane] || c.in[1][lane] ? kFirst + random() % kPixels : static_cast<cl_uint>(random());
  for (auto& pixel : c.film)
    for (cl_long& sum : pixel)
      sum = random() % 4 ? static_cast<cl_long>(random()) << random() % 20
                         : std::numeric_limits<cl_long>::max() - random();
  return c;
}

Result expected(const Case& c) {
  Result r{};
  __int128 sums[kPixels][3];
  for (int p = 0; p < kPixels; ++p) std::copy_n(c.film[p], 3, sums[p]);
  for (int k = 0; k < 2; ++k)
    for (int lane = 0; lane < 16; ++lane) {
      if (!c.in[k][lane]) continue;
      bool nan = false;
      for (int channel = 0; channel < 3; ++channel) {
        const float v = c.light[k][channel][lane];
        nan |= std::isnan(v);
        if (std::isnan(v)) continue;
        sums[c.pixel[lane] - kFirst][channel] +=
            static_cast<cl_long>(std::nearbyint(std::min(v, KDRAY_FILM_MAX) * KDRAY_FILM_SCALE));
      }
      r.n_nan += nan;
    }
  for (int p = 0; p < kPixels; ++p)
    for (int channel = 0; channel < 3; ++channel)
      r.film[p][channel] =
          static_cast<cl_long>(std::min<__int128>(sums[p][channel], std::numeric_limits<cl_long>::max()));
  return r;
}

class FilmTest : public test::EachDevice {};

void expect_exact_sums(const std::string& device, const std::string& options) {
  const unsigned seed = 31;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<Case> in;
  for (int i = 0; i < 2000; ++i) in.push_back(some_case(random));
  const std::vector<Result> out = test::run_kernel<Result>(device, kSource, in, options);
  int saturated = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Result wanted = expected(in[i]);
    EXPECT_EQ(out[i].n_nan, wanted.n_nan) << i;
    for (int p = 0; p < kPixels; ++p)
      for (int channel = 0; channel < 3; ++channel) {
        ASSERT_EQ(out[i].film[p][channel], wanted.film[p][channel])
            << i << ", pixel " << p << ", channel " << channel;
        saturated += wanted.film[p][channel] == std::numeric_limits<cl_long>::max();
      }
  }
  EXPECT_GT(saturated, 100);
}

TEST_P(FilmTest, SumsAreExactInEveryFormOfVectors) {
  const device::FoundDevice found = device::choose_device(GetParam());
  const device::Context context(GetParam(), 1);
  for (const device::Simd form : {device::Simd::portable, device::Simd::avx2, device::Simd::avx512})
    if (device::why_not(form, found, context.opened()).empty()) {
      SCOPED_TRACE(device::in_words(form));
      expect_exact_sums(GetParam(), device::build_option(form));
    }
}

TEST_P(FilmTest, SumsAreExactInDouble) {
  if (!test::computes_in_double(GetParam()))
    GTEST_SKIP() << "device " << GetParam() << " does not compute in double";
  expect_exact_sums(GetParam(), "-DKDRAY_PRECISION=64");
}

KDRAY_FOR_EACH_DEVICE(FilmTest);

}  // namespace
}  // namespace kdray
