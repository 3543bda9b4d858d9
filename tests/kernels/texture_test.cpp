// Textures against a sampler in double that says step by step what glTF 2.0 (3.8.4) and OpenGL mean by
// wrapping, nearest and linear: within what 256ths of a texel and 16 bits may be off. At texels' middles, and
// for nearest anywhere but at their borders, the answers are the texels' own, exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "layout/textures.layout.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

constexpr std::size_t kMostTexels = 40;

struct Case {
  float u, v;
  layout::Texture texture;
  layout::u32 texels[KDRAY_TEXEL_CURVE + kMostTexels];
};

constexpr const char* kSource = R"(#include "layout/base.layout.h"
#include "layout/textures.layout.h"
#include "layout/primitives.layout.h"
#include "textures/texture.clh"
typedef struct Case {
  float u, v;
  Texture texture;
  u32 texels[KDRAY_TEXEL_CURVE + 40];
} Case;
__kernel void test(__global const Case* in, __global uint4* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  TexturingArrays texturing;
  texturing.texels = in[i].texels;
  out[i] = sample_texture(&texturing, &in[i].texture, in[i].u, in[i].v);
}
)";

double curve(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

// The texel that a whole coordinate means, by the definitions of glTF's three modes.
long wrapped(long i, long n, layout::u32 mode) {
  const auto modulo = [](long a, long b) { return ((a % b) + b) % b; };
  if (mode == KDRAY_WRAP_CLAMP) return std::clamp(i, 0L, n - 1);
  if (mode == KDRAY_WRAP_REPEAT) return modulo(i, n);
  const long m = modulo(i, 2 * n);
  return m < n ? m : 2 * n - 1 - m;
}

std::array<double, 4> texel(const Case& c, long x, long y) {
  const layout::Texture& t = c.texture;
  const long w = t.width, h = t.height;
  x = wrapped(x, w, KDRAY_WRAP_ACROSS(t.how));
  y = wrapped(y, h, KDRAY_WRAP_DOWN(t.how));
  const layout::u32 word = c.texels[t.first + static_cast<layout::u32>(y * w + x)];
  std::array<double, 4> out;
  for (unsigned k = 0; k < 4; ++k) {
    const double code = (word >> (8 * k) & 255u) / 255.0;
    out[k] = k < 3 && (t.how & KDRAY_TEXTURE_CURVED) ? curve(code) : code;
  }
  return out;
}

std::array<double, 4> reference(const Case& c) {
  const double x = double{c.u} * c.texture.width, y = double{c.v} * c.texture.height;
  if (c.texture.how & KDRAY_TEXTURE_NEAREST)
    return texel(c, static_cast<long>(std::floor(x)), static_cast<long>(std::floor(y)));
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5), fx = x - 0.5 - left, fy = y - 0.5 - top;
  std::array<double, 4> sum{};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const auto at = texel(c, static_cast<long>(left) + i, static_cast<long>(top) + j);
      for (std::size_t k = 0; k < 4; ++k) sum[k] += at[k] * (i ? fx : 1 - fx) * (j ? fy : 1 - fy);
    }
  return sum;
}

// Whether a coordinate lies so near to a texel's border that rounding may take either side.
bool at_border(float u, layout::u32 n) {
  const double x = double{u} * n;
  return std::abs(x - std::round(x)) < 1.0 / 200;
}

Case random_case(std::mt19937& random, layout::u32 how) {
  Case c{};
  for (layout::u32 i = 0; i < KDRAY_TEXEL_CURVE; ++i)
    c.texels[i] = static_cast<layout::u32>(std::lround(65535 * curve(i / 255.0)));
  for (std::size_t i = KDRAY_TEXEL_CURVE; i < std::size(c.texels); ++i) c.texels[i] = random();
  c.texture.first = KDRAY_TEXEL_CURVE;
  c.texture.width = 1 + random() % 8;
  c.texture.height = 1 + random() % 5;
  c.texture.how = how;
  std::uniform_real_distribution<float> place(-3, 4);
  c.u = place(random);
  c.v = place(random);
  if (random() % 8 == 0) c.u = std::round(c.u);
  return c;
}

std::vector<layout::u32> all_hows() {
  std::vector<layout::u32> hows;
  for (const layout::u32 across : {KDRAY_WRAP_REPEAT, KDRAY_WRAP_MIRROR, KDRAY_WRAP_CLAMP})
    for (const layout::u32 down : {KDRAY_WRAP_REPEAT, KDRAY_WRAP_MIRROR, KDRAY_WRAP_CLAMP})
      for (const layout::u32 other :
           {0u, KDRAY_TEXTURE_NEAREST, KDRAY_TEXTURE_CURVED, KDRAY_TEXTURE_NEAREST | KDRAY_TEXTURE_CURVED})
        hows.push_back(across | down << 2 | other);
  return hows;
}

struct Answer {
  layout::u32 c[4];
};

class TextureTest : public test::EachDevice {
 protected:
  std::vector<Answer> sample(const std::vector<Case>& cases, const std::string& options = "") {
    return test::run_kernel<Answer>(GetParam(), kSource, cases, options);
  }
};

TEST_P(TextureTest, IsThatOfTheSpecification) {
  const unsigned seed = 28;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<Case> cases;
  for (const layout::u32 how : all_hows())
    for (int i = 0; i < 200; ++i) cases.push_back(random_case(random, how));
  const std::vector<Answer> answers = sample(cases);
  std::size_t n_checked = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const bool nearest = (c.texture.how & KDRAY_TEXTURE_NEAREST) != 0;
    if (nearest && (at_border(c.u, c.texture.width) || at_border(c.v, c.texture.height))) continue;
    const auto wanted = reference(c);
    // A 512th of a texel along each axis, half a 65535th for each texel's rounding and for that of the sum.
    const double bound = nearest ? 0.5 / 65535 : 2.0 / 512 + 1e-5 + 1.0 / 65535;
    for (std::size_t k = 0; k < 4; ++k)
      ASSERT_NEAR(answers[i].c[k] / 65535.0, wanted[k], bound)
          << "case " << i << ", how " << c.texture.how << ", (" << c.u << ", " << c.v << ") of "
          << c.texture.width << "x" << c.texture.height << ", channel " << k;
    ++n_checked;
  }
  EXPECT_GT(n_checked, 6000u);
}

TEST_P(TextureTest, MiddlesShowTheTexelsThemselves) {
  std::mt19937 random(29);
  std::vector<Case> cases;
  for (const layout::u32 how : all_hows()) {
    Case c = random_case(random, how);
    c.texture.width = 8;
    c.texture.height = 4;
    const auto x = static_cast<float>(static_cast<int>(random() % 40) - 20);
    const auto y = static_cast<float>(static_cast<int>(random() % 40) - 20);
    c.u = (x + 0.5f) / 8;
    c.v = (y + 0.5f) / 4;
    cases.push_back(c);
  }
  const std::vector<Answer> answers = sample(cases);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto wanted = reference(cases[i]);
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_EQ(answers[i].c[k], static_cast<layout::u32>(std::lround(65535 * wanted[k]))) << i;
  }
}

// What is no number, or so far off that no texel is meant, is one of the picture's texels all the same.
TEST_P(TextureTest, OddCoordinatesStayInThePicture) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  std::mt19937 random(30);
  std::vector<Case> cases;
  for (const layout::u32 how : all_hows())
    for (const float odd : {inf, -inf, nan, 1e30f, -1e30f, 3e38f, -1e-45f, -0.0f, 16777216.0f, -1e-9f}) {
      Case c = random_case(random, how & ~KDRAY_TEXTURE_CURVED);
      std::fill(std::begin(c.texels) + KDRAY_TEXEL_CURVE, std::end(c.texels), 0xffffffffu);
      for (std::size_t i = KDRAY_TEXEL_CURVE + c.texture.width * c.texture.height; i < std::size(c.texels);
           ++i)
        c.texels[i] = 0;
      (random() % 2 ? c.u : c.v) = odd;
      cases.push_back(c);
    }
  for (const Answer& a : sample(cases))
    for (const layout::u32 channel : a.c) EXPECT_EQ(channel, 65535u);
}

// Whole numbers are the same in both precisions where the coordinate is.
TEST_P(TextureTest, IsTheSameInDouble) {
  if (!test::computes_in_double(GetParam())) GTEST_SKIP() << "no double";
  std::mt19937 random(31);
  std::vector<Case> cases;
  for (const layout::u32 how : all_hows()) {
    Case c = random_case(random, how);
    c.u = static_cast<float>(static_cast<int>(random() % 4096) - 2048) / 512;
    c.v = static_cast<float>(static_cast<int>(random() % 4096) - 2048) / 512;
    c.texture.width = 4;
    c.texture.height = 2;
    cases.push_back(c);
  }
  const auto in_float = sample(cases), in_double = sample(cases, "-DKDRAY_PRECISION=64");
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(in_float[i].c[k], in_double[i].c[k]) << i;
}

KDRAY_FOR_EACH_DEVICE(TextureTest);

}  // namespace
}  // namespace kdray
