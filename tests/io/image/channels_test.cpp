#include "io/image/channels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "io/image/color.h"
#include "support/errors.h"

namespace kdray::image {
namespace {

using Samples = std::vector<std::uint16_t>;

TEST(ChannelPictures, DepthIsNearWhiteFarBlackBackgroundZero) {
  const Channel depth{"depth", {2, 4, 3, INFINITY}};
  const auto pictures = channel_pictures(4, 1, {&depth, 1});
  ASSERT_EQ(pictures.size(), 1u);
  EXPECT_EQ(pictures[0].name, "depth");
  EXPECT_EQ(pictures[0].pixels.bits, 16);
  EXPECT_EQ(pictures[0].pixels.channels, 1);
  EXPECT_EQ(pictures[0].pixels.samples, (Samples{65535, 1, 32768, 0}));
  EXPECT_EQ(pictures[0].meta.comment, "depth: 65535 is 2, 1 is 4, 0 is background");
}

TEST(ChannelPictures, DepthOfNothingAndOfOnePlane) {
  const Channel none{"depth", {INFINITY, INFINITY}}, plane{"depth", {3, 3}};
  EXPECT_EQ(channel_pictures(2, 1, {&none, 1})[0].pixels.samples, (Samples{0, 0}));
  EXPECT_EQ(channel_pictures(2, 1, {&plane, 1})[0].pixels.samples, (Samples{65535, 65535}));
}

TEST(ChannelPictures, ANormalIsOnePictureOfThreeChannels) {
  const std::vector<Channel> normal = {{"normal.x", {1, 0}}, {"normal.y", {-1, 0}}, {"normal.z", {0, 0}}};
  const auto pictures = channel_pictures(2, 1, normal);
  ASSERT_EQ(pictures.size(), 1u);
  EXPECT_EQ(pictures[0].name, "normal");
  EXPECT_EQ(pictures[0].pixels.samples, (Samples{255, 0, 128, 128, 128, 128}));
  EXPECT_TRUE(test::fails(
      [&] {
        channel_pictures(2, 1, {normal.data(), 2});
      },
      "normal", ErrorCode::internal));
}

TEST(ChannelPictures, PrimitivesHaveColoursOfTheirOwn) {
  Channel primitive{"primitive", {-1}};
  for (int i = 0; i < 999; ++i) primitive.values.push_back(static_cast<float>(i));
  const Samples samples = channel_pictures(1000, 1, {&primitive, 1})[0].pixels.samples;
  EXPECT_EQ(Samples(samples.begin(), samples.begin() + 3), (Samples{0, 0, 0}));
  std::set<Samples> colors;
  for (std::size_t i = 3; i < samples.size(); i += 3) {
    EXPECT_GE(std::min({samples[i], samples[i + 1], samples[i + 2]}), 64);
    colors.insert({samples[i], samples[i + 1], samples[i + 2]});
  }
  EXPECT_GE(colors.size(), 997u);
}

TEST(ChannelPictures, QueuesHaveColoursAsBrightAsThePicture) {
  Channel queue{"queue", {0, 1, kNoQueue, kEveryQueue, 0}};
  const auto color = [](const Samples& s, std::size_t i) {
    return Samples(s.begin() + static_cast<std::ptrdiff_t>(3 * i),
                   s.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
  };
  const Samples flat = channel_pictures(5, 1, {&queue, 1})[0].pixels.samples;
  EXPECT_EQ(color(flat, 0), (Samples{230, 159, 0}));
  EXPECT_EQ(color(flat, 2), (Samples{0, 0, 0}));
  EXPECT_EQ(color(flat, 3), (Samples{200, 200, 200}));
  const std::vector<vec3> image = {vec3(1), vec3(1), vec3(1), vec3(1), vec3(0)};
  const Samples shaded = channel_pictures(5, 1, {&queue, 1}, image)[0].pixels.samples;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(color(shaded, i), color(flat, i)) << "white changes nothing";
  EXPECT_EQ(color(shaded, 4), (Samples{58, 40, 0})) << "a quarter, so that black can be told";
  std::set<std::array<std::uint8_t, 3>> colors;
  for (std::size_t q = 0; q < 64; ++q) {
    const std::array<std::uint8_t, 3> color = queue_color(q);
    colors.insert(color);
    EXPECT_GE(std::ranges::max(color), 150);
  }
  EXPECT_EQ(colors.size(), 64u);
}

TEST(ChannelPictures, CostRunsFromBlackToTheHottest) {
  const Channel cost{"cost", {0, 10, 5}};
  const ChannelPicture picture = channel_pictures(3, 1, {&cost, 1})[0];
  const Samples& s = picture.pixels.samples;
  EXPECT_EQ(picture.meta.color, PngColor::srgb);
  EXPECT_EQ(Samples(s.begin(), s.begin() + 3), (Samples{0, 0, 0}));
  EXPECT_EQ(Samples(s.begin() + 3, s.begin() + 6), (Samples{252, 252, 204}));
  EXPECT_GT(s[6], s[8]);  // half way the map is reddish
}

}  // namespace
}  // namespace kdray::image
