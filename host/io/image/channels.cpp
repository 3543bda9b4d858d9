#include "io/image/channels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "io/image/color.h"

namespace kdray::image {
namespace {

struct Range {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

Range finite_range(const std::vector<float>& values) {
  Range range;
  for (float v : values)
    if (std::isfinite(v)) range.low = std::min(range.low, v), range.high = std::max(range.high, v);
  return range;
}

PngPixels blank(int width, int height, int channels, int bits) {
  PngPixels pixels{width, height, channels, bits, {}};
  pixels.samples.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                        static_cast<std::size_t>(channels));
  return pixels;
}

std::string range_comment(const char* format, const Range& range) {
  char text[96];
  std::snprintf(text, sizeof text, format, static_cast<double>(range.low), static_cast<double>(range.high));
  return range.low <= range.high ? text : "nothing is hit";
}

// Near is white; far is 1, not 0, so that the background (0) can be told from the farthest surface.
ChannelPicture depth_picture(int width, int height, const std::vector<float>& depth) {
  ChannelPicture picture{"depth", blank(width, height, 1, 16), {}};
  const Range range = finite_range(depth);
  picture.meta.comment = range_comment("depth: 65535 is %.9g, 1 is %.9g, 0 is background", range);
  const double span = static_cast<double>(range.high) - range.low;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!std::isfinite(depth[i])) continue;
    const double farness = span > 0 ? (depth[i] - static_cast<double>(range.low)) / span : 0;
    picture.pixels.samples[i] = static_cast<std::uint16_t>(std::lround(65535 - 65534 * farness));
  }
  return picture;
}

ChannelPicture normal_picture(int width, int height, const std::vector<float>* const parts[3]) {
  ChannelPicture picture{"normal", blank(width, height, 3, 8), {}};
  picture.meta.comment = "normal: 0 is -1, 255 is 1";
  for (std::size_t i = 0; i < parts[0]->size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float n = (*parts[c])[i];
      const double share = n == n ? std::clamp(0.5 + 0.5 * static_cast<double>(n), 0.0, 1.0) : 0;
      picture.pixels.samples[3 * i + c] = static_cast<std::uint16_t>(std::lround(255 * share));
    }
  return picture;
}

// Neighbouring numbers get unlike colours, none of them near black. The mixing is a 32-bit finaliser
// (Degski's constants), a bijection; each colour takes a byte of it.
ChannelPicture number_picture(int width, int height, const Channel& channel) {
  const std::vector<float>& numbers = channel.values;
  ChannelPicture picture{channel.name, blank(width, height, 3, 8), {}};
  picture.meta.comment = channel.name + ": a colour per number, black is " +
                         (channel.name == "instance" ? "none" : "background");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!(numbers[i] >= 0 && numbers[i] < 4294967296.0f)) continue;
    auto bits = static_cast<std::uint32_t>(numbers[i]);
    bits = (bits ^ (bits >> 16)) * 0x45d9f3bu;
    bits = (bits ^ (bits >> 16)) * 0x45d9f3bu;
    bits ^= bits >> 16;
    for (std::size_t c = 0; c < 3; ++c)
      picture.pixels.samples[3 * i + c] =
          static_cast<std::uint16_t>(64 + ((bits >> (8 * c)) & 255) * 191 / 255);
  }
  return picture;
}

// 0 is black, the largest value the hottest colour.
ChannelPicture heat_picture(int width, int height, const Channel& channel) {
  ChannelPicture picture{channel.name, blank(width, height, 3, 8), {}};
  const Range range{0, finite_range(channel.values).high};
  picture.meta.color = PngColor::srgb;
  picture.meta.comment = channel.name + ": " + range_comment("black is %.9g, light yellow is %.9g", range);
  const Quantizer quantize(Transfer{}, 255);
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const double share = range.high > 0 ? channel.values[i] / static_cast<double>(range.high) : 0;
    const vec3 color = heat(share);
    for (int c = 0; c < 3; ++c)
      picture.pixels.samples[3 * i + static_cast<std::size_t>(c)] =
          static_cast<std::uint16_t>(quantize(color[c]));
  }
  return picture;
}

// Returns how bright a colour is, from a quarter to 1, so that black places still show their queue.
double brightness(const vec3& color) {
  const double luma = 0.2126 * static_cast<double>(color.x) + 0.7152 * static_cast<double>(color.y) +
                      0.0722 * static_cast<double>(color.z);
  return 0.25 + 0.75 * encode(Transfer{}, luma > 0 ? std::min(luma, 1.0) : 0.0);
}

// Pixels of no queue are black, those of every queue grey.
ChannelPicture queue_picture(int width, int height, const std::vector<float>& queues,
                             std::span<const vec3> image) {
  ChannelPicture picture{"queue", blank(width, height, 3, 8), {}};
  picture.meta.comment = "queue: a colour per queue, grey is every queue, black is none";
  for (std::size_t i = 0; i < queues.size(); ++i) {
    if (!(queues[i] >= 0 || queues[i] == kEveryQueue)) continue;
    constexpr std::array<std::uint8_t, 3> kGrey = {200, 200, 200};
    const auto color = queues[i] >= 0 ? queue_color(static_cast<std::size_t>(queues[i])) : kGrey;
    const double shade = image.empty() ? 1 : brightness(image[i]);
    for (std::size_t c = 0; c < 3; ++c)
      picture.pixels.samples[3 * i + c] = static_cast<std::uint16_t>(std::lround(shade * color[c]));
  }
  return picture;
}

const Channel* find(std::span<const Channel> channels, const std::string& name) {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

}  // namespace

std::vector<ChannelPicture> channel_pictures(int width, int height, std::span<const Channel> channels,
                                             std::span<const vec3> image) {
  std::vector<ChannelPicture> pictures;
  for (const Channel& channel : channels) {
    if (channel.name == "depth") {
      pictures.push_back(depth_picture(width, height, channel.values));
    } else if (channel.name == "primitive" || channel.name == "instance") {
      pictures.push_back(number_picture(width, height, channel));
    } else if (channel.name == "queue") {
      pictures.push_back(queue_picture(width, height, channel.values, image));
    } else if (channel.name == "normal.x") {
      const Channel *y = find(channels, "normal.y"), *z = find(channels, "normal.z");
      if (!y || !z) throw Error(ErrorCode::internal, "a normal needs its x, y and z channels");
      const std::vector<float>* const parts[3] = {&channel.values, &y->values, &z->values};
      pictures.push_back(normal_picture(width, height, parts));
    } else if (channel.name != "normal.y" && channel.name != "normal.z") {
      pictures.push_back(heat_picture(width, height, channel));
    }
  }
  return pictures;
}

}  // namespace kdray::image
