// What    Footprints against the geometry that they stand for, in double; and which mipmaps they choose, in
//         pictures whose levels are told apart by their colours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/vec.h"
#include "layout/textures.layout.h"
#include "support/device.h"
#include "support/run_kernel.h"

namespace kdray {
namespace {

constexpr std::size_t kTexels = KDRAY_TEXEL_CURVE + 32 * 32 * 4 / 3 + 1;

constexpr const char* kPrelude = R"(#include "layout/base.layout.h"
#include "layout/textures.layout.h"
#include "layout/primitives.layout.h"
#include "textures/footprint.clh"
)";

struct Seen {
  float corners[9];
  float direction[3];
  float width, squared;
};
struct Weights {
  float along[2], across[2];
  layout::u32 level;
};

const std::string kSeenSource = std::string(kPrelude) + R"(
typedef struct Seen { float corners[9], direction[3], width, squared; } Seen;
typedef struct Weights { float along[2], across[2]; u32 level; } Weights;
__kernel void test(__global const Seen* in, __global Weights* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  const Plane plane = plane_of((__global const Triangle*)in[i].corners);
  const Footprint f = footprint_on(&plane, load3(in[i].direction), in[i].width);
  for (int k = 0; k < 2; ++k) out[i].along[k] = f.along[k], out[i].across[k] = f.across[k];
  out[i].level = level_256(in[i].squared);
}
)";

class FootprintTest : public test::EachDevice {};

// The axes lie in the plane, one along the ray's way and one across it, and are as long as the cone is wide
// there.
TEST_P(FootprintTest, IsWhereTheConeMeetsThePlane) {
  std::mt19937 random(59);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-30, 30);
  const auto vector = [&] { return dvec3(normal(random), normal(random), normal(random)); };
  std::vector<Seen> cases;
  for (int i = 0; i < 2000; ++i) {
    Seen s{};
    const double size = std::exp2(exponent(random));
    for (int corner = 0; corner < 3; ++corner) {
      const dvec3 v = vector() * size;
      for (int k = 0; k < 3; ++k) s.corners[3 * corner + k] = static_cast<float>(v[k]);
    }
    const dvec3 d = glm::normalize(vector());
    for (int k = 0; k < 3; ++k) s.direction[k] = static_cast<float>(d[k]);
    s.width = static_cast<float>(size * std::exp2(exponent(random) / 3));
    s.squared = static_cast<float>(std::exp2(std::abs(exponent(random))));
    if (!(s.squared > 1)) s.squared = 1.5f;
    cases.push_back(s);
  }
  const auto answers = test::run_kernel<Weights>(GetParam(), kSeenSource, cases);
  int n_checked = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Seen& s = cases[i];
    EXPECT_NEAR(answers[i].level, 128 * std::log2(double{s.squared}), 2.5) << s.squared;
    const auto at = [&](int k) {
      return dvec3(s.corners[3 * k], s.corners[3 * k + 1], s.corners[3 * k + 2]);
    };
    const dvec3 e1 = at(1) - at(0), e2 = at(2) - at(0), n = glm::normalize(glm::cross(e1, e2));
    const dvec3 d(s.direction[0], s.direction[1], s.direction[2]);
    const double sine = glm::length(glm::cross(e1, e2)) / glm::length(e1) / glm::length(e2);
    const double cosine = std::abs(glm::dot(n, d));
    if (sine < 0.05 || cosine < 0.01 || cosine > 0.999) continue;
    ++n_checked;
    const dvec3 along = double{answers[i].along[0]} * e1 + double{answers[i].along[1]} * e2;
    const dvec3 across = double{answers[i].across[0]} * e1 + double{answers[i].across[1]} * e2;
    EXPECT_NEAR(glm::length(across) / s.width, 1, 2e-4);
    EXPECT_NEAR(glm::length(along) / s.width * cosine, 1, 2e-4);
    EXPECT_NEAR(glm::dot(across, d) / s.width, 0, 2e-4);
    EXPECT_NEAR(glm::length(glm::cross(glm::normalize(along), glm::normalize(d - n * glm::dot(n, d)))), 0,
                2e-3);
  }
  EXPECT_GT(n_checked, 1500);
}

struct Looked {
  float along[2], across[2];  // axes, in shares of the picture
  layout::Texture texture;
  layout::u32 texels[kTexels];
};
struct Answer {
  layout::u32 c[4];
};

const std::string kLookedSource = std::string(kPrelude) + R"(
typedef struct Looked { float along[2], across[2]; Texture texture; u32 texels[)" +
                                  std::to_string(kTexels) +
                                  R"(]; } Looked;
__kernel void test(__global const Looked* in, __global uint4* out, uint n) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  TexturingArrays texturing;
  texturing.texels = in[i].texels;
  __global const Texture* t = &in[i].texture;
  const Axis a = axis_of(t, in[i].along[0], in[i].along[1]), b = axis_of(t, in[i].across[0], in[i].across[1]);
  out[i] = sample_footprint(&texturing, t, 0.37f, 0.61f, &a, &b);
}
)";

// Level k shows 30*k everywhere.
Looked in_levels(layout::u32 how, double along, double across) {
  Looked l{};
  l.along[0] = static_cast<float>(along / 32);
  l.across[1] = static_cast<float>(across / 32);
  l.texture.across[0] = l.texture.down[1] = 1;
  l.texture.first = KDRAY_TEXEL_CURVE;
  l.texture.width = l.texture.height = 32;
  l.texture.how = how;
  l.texture.n_levels = 6;
  std::size_t place = KDRAY_TEXEL_CURVE;
  for (layout::u32 k = 0; k < 6; ++k)
    for (layout::u32 i = 0; i < (1024u >> (2 * k)); ++i) l.texels[place++] = 0x01010101u * (30 * k);
  return l;
}

double level_shown(const Answer& a) {
  return a.c[0] / 257.0 / 30;
}

class MipmapChoiceTest : public test::EachDevice {
 protected:
  std::vector<double> levels(const std::vector<Looked>& cases) {
    std::vector<double> out;
    for (const Answer& a : test::run_kernel<Answer>(GetParam(), kLookedSource, cases)) {
      for (const layout::u32 c : a.c) EXPECT_EQ(c, a.c[0]);
      out.push_back(level_shown(a));
    }
    return out;
  }
};

TEST_P(MipmapChoiceTest, FollowsTheFootprintsWidth) {
  std::vector<Looked> mixed, nearest, none;
  std::vector<double> wanted;
  for (double size = 0.3; size < 200; size *= 1.1) {
    mixed.push_back(in_levels(KDRAY_TEXTURE_MIPMAPS | KDRAY_TEXTURE_MIP_LINEAR, size, size));
    nearest.push_back(in_levels(KDRAY_TEXTURE_MIPMAPS, size, size));
    none.push_back(in_levels(KDRAY_TEXTURE_NEAREST, size, size));
    wanted.push_back(std::clamp(std::log2(size), 0.0, 5.0));
  }
  const auto got = levels(mixed), got_nearest = levels(nearest), got_none = levels(none);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(got[i], wanted[i], 0.015) << i;
    if (std::abs(wanted[i] - std::floor(wanted[i]) - 0.5) > 0.02) {
      EXPECT_EQ(got_nearest[i], std::round(wanted[i]));
    }
    EXPECT_EQ(got_none[i], 0);
  }
}

// A long footprint is looked at in several places, at the level of its width; beyond eight it is as wide as
// an eighth of its length.
TEST_P(MipmapChoiceTest, LongFootprintsStaySharp) {
  const layout::u32 how = KDRAY_TEXTURE_MIPMAPS | KDRAY_TEXTURE_MIP_LINEAR;
  const auto got = levels({in_levels(how, 8, 2), in_levels(how, 2, 8), in_levels(how, 16, 2),
                           in_levels(how, 64, 2), in_levels(how, 6, 0.01)});
  EXPECT_NEAR(got[0], 1, 0.01);
  EXPECT_NEAR(got[1], 1, 0.01);
  EXPECT_NEAR(got[2], 1, 0.01);
  EXPECT_NEAR(got[3], 3, 0.01);
  EXPECT_NEAR(got[4], 0, 0.01);
}

TEST_P(MipmapChoiceTest, WhatHasNoSizeIsAPoint) {
  const layout::u32 how = KDRAY_TEXTURE_MIPMAPS | KDRAY_TEXTURE_MIP_LINEAR;
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const auto got = levels({in_levels(how, nan, 1), in_levels(how, 0, 0), in_levels(how, inf, inf),
                           in_levels(how, 1e30, 1e30), in_levels(how, inf, 0.1)});
  EXPECT_EQ(got[1], 0);
  for (const double level : got) {
    EXPECT_GE(level, 0);
    EXPECT_LE(level, 5);
  }
}

KDRAY_FOR_EACH_DEVICE(FootprintTest);
KDRAY_FOR_EACH_DEVICE(MipmapChoiceTest);

}  // namespace
}  // namespace kdray
