// What    Mipmaps against means in double over what each texel covers of the level before; and where the
//         texels of a scene's textures lie.
#include "scene/textures/mipmaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "accel/flatten/textures.h"

namespace kdray::flatten {
using scene::level_sizes, scene::LevelSize, scene::write_levels;

namespace {

scene::Picture noise(std::uint32_t width, std::uint32_t height) {
  scene::Picture picture = scene::blank_picture("noise", width, height);
  std::mt19937 random(width * 1000 + height);
  for (std::uint8_t& byte : picture.texels) byte = static_cast<std::uint8_t>(random());
  return picture;
}

double linear_of(double code, bool curved) {
  const double c = code / 255;
  if (!curved) return c;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double code_of(double linear, bool curved) {
  if (!curved) return 255 * linear;
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

// The means of each channel over the share of the level that texel (x, y) of the next covers.
using Level = std::vector<std::array<double, 4>>;
Level halved(const Level& level, LevelSize from, LevelSize to) {
  Level out;
  for (std::uint32_t y = 0; y < to.height; ++y)
    for (std::uint32_t x = 0; x < to.width; ++x) {
      const double w = double(from.width) / to.width, h = double(from.height) / to.height;
      std::array<double, 4> sum{};
      for (std::uint32_t j = 0; j < from.height; ++j)
        for (std::uint32_t i = 0; i < from.width; ++i) {
          const double across = std::min(i + 1.0, (x + 1) * w) - std::max(double(i), x * w);
          const double down = std::min(j + 1.0, (y + 1) * h) - std::max(double(j), y * h);
          if (across <= 0 || down <= 0) continue;
          for (std::size_t c = 0; c < 4; ++c)
            sum[c] += level[j * from.width + i][c] * across * down / (w * h);
        }
      out.push_back(sum);
    }
  return out;
}

TEST(Mipmaps, SizesGoDownToOne) {
  const auto sizes = level_sizes(13, 4);
  ASSERT_EQ(sizes.size(), 4u);
  EXPECT_EQ(sizes[1].width, 6u);
  EXPECT_EQ(sizes[1].height, 2u);
  EXPECT_EQ(sizes[2].width, 3u);
  EXPECT_EQ(sizes[2].height, 1u);
  EXPECT_EQ(sizes[3].texels(), 1u);
  EXPECT_EQ(level_sizes(1, 1).size(), 1u);
}

TEST(Mipmaps, AreMeansOfWhatTheyCover) {
  for (const auto& [width, height] : {std::pair{16u, 8u}, {13u, 5u}, {7u, 1u}, {1u, 9u}, {2u, 3u}})
    for (const bool curved : {true, false}) {
      const scene::Picture picture = noise(width, height);
      const auto sizes = level_sizes(width, height);
      std::size_t n = 0;
      for (const LevelSize& size : sizes) n += size.texels();
      std::vector<std::uint32_t> words(n);
      write_levels(picture, curved, 0, sizes.size(), words);
      Level level;
      for (std::size_t i = 0; i < sizes[0].texels(); ++i) {
        level.emplace_back();
        for (std::size_t c = 0; c < 4; ++c) {
          EXPECT_EQ(words[i] >> (8 * c) & 255u, picture.texels[4 * i + c]);
          level.back()[c] = linear_of(picture.texels[4 * i + c], curved && c < 3);
        }
      }
      std::size_t place = sizes[0].texels();
      for (std::size_t k = 1; k < sizes.size(); ++k) {
        level = halved(level, sizes[k - 1], sizes[k]);
        for (const auto& texel : level) {
          for (std::size_t c = 0; c < 4; ++c) {
            const double wanted = code_of(texel[c], curved && c < 3), got = words[place] >> (8 * c) & 255u;
            EXPECT_NEAR(got, wanted, 0.52) << width << "x" << height << " level " << k << " channel " << c;
          }
          ++place;
        }
      }
    }
}

TEST(Mipmaps, BlackAndWhiteIsHalfTheLight) {
  scene::Picture picture = scene::blank_picture("checker", 2, 2);
  for (int i = 0; i < 16; ++i) picture.texels[i] = i / 4 == 1 || i / 4 == 2 ? 255 : 0;
  std::vector<std::uint32_t> words(5);
  write_levels(picture, true, 0, 2, words);
  EXPECT_EQ(words[4], 0x80bcbcbcu);  // 188 is half the light; alpha has no curve
}

TEST(Mipmaps, TheLaterLevelsAreTheSameWithoutTheFirst) {
  const scene::Picture picture = noise(12, 20);
  const auto sizes = level_sizes(12, 20);
  std::vector<std::uint32_t> all(12 * 20 * 2), rest(12 * 20);
  write_levels(picture, true, 0, sizes.size(), all);
  write_levels(picture, true, 2, sizes.size() - 2, rest);
  const std::size_t skipped = sizes[0].texels() + sizes[1].texels();
  for (std::size_t i = 0; i < sizes[2].texels(); ++i) EXPECT_EQ(rest[i], all[skipped + i]);
}

// One with mipmaps serves one without; of both kinds of colours there are two.
TEST(Texels, EachPictureLiesThereOnce) {
  scene::Texturing texturing;
  texturing.add(std::make_shared<const scene::Picture>(noise(8, 8)));
  texturing.add(scene::Texture{});
  texturing.add(scene::Texture{.minify = scene::Minify::linear_mipmap_linear});
  texturing.add(scene::Texture{.nearest = true, .minify = scene::Minify::nearest_mipmap_nearest});
  texturing.add(scene::Texture{.minify = scene::Minify::linear_mipmap_linear, .curved = false});
  texturing.add(scene::Texture{.curved = false});
  const TexelPlan plan = plan_texels(texturing);
  EXPECT_EQ(plan.chains.size(), 2u);
  EXPECT_EQ(plan.chain_of, (std::vector<std::size_t>{0, 0, 0, 1, 0}));
  EXPECT_EQ(plan.n_texels, KDRAY_TEXEL_CURVE + 2 * (64u + 16 + 4 + 1));
  EXPECT_EQ(plan.chains[1].first, KDRAY_TEXEL_CURVE + 85u);
  EXPECT_EQ(pack_texels(texturing, plan).size(), plan.n_texels);
}

}  // namespace
}  // namespace kdray::flatten
