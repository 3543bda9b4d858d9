#include "apps/view/pixels.h"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "io/image/channels.h"
#include "io/image/color.h"
#include "io/image/picture_file.h"
#include "io/image/png.h"
#include "kdray/kdray.h"

namespace kdray::view {

namespace {

struct JpegOptions {
  int quality = 80;
  bool full_color = false;  // each pixel has its own colour (4:4:4), or four share one (4:2:0)
};

constexpr int kTable = 16384;

const std::array<unsigned char, kTable + 1>& display_table() {
  static const auto table = [] {
    std::array<unsigned char, kTable + 1> codes{};
    for (int i = 0; i <= kTable; ++i)
      codes[static_cast<std::size_t>(i)] = static_cast<unsigned char>(
          255 * image::encode(image::Transfer{}, static_cast<double>(i) / kTable) + 0.5);
    return codes;
  }();
  return table;
}

struct Free {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

std::string compress(const std::vector<unsigned char>& bytes, int width, int height, bool grey,
                     const JpegOptions& options) {
  const std::unique_ptr<void, int (*)(tjhandle)> jpeg(tjInitCompress(), tjDestroy);
  if (!jpeg) throw Error(ErrorCode::internal, "libjpeg-turbo can't be started");
  unsigned char* out = nullptr;
  unsigned long n = 0;
  const int colors = grey ? TJSAMP_GRAY : options.full_color ? TJSAMP_444 : TJSAMP_420;
  const int status =
      tjCompress2(jpeg.get(), bytes.data(), width, 0, height, grey ? TJPF_GRAY : TJPF_RGB, &out, &n, colors,
                  options.quality, TJFLAG_FASTDCT * (options.full_color ? 0 : 1));
  const std::unique_ptr<unsigned char, Free> owned(out);
  if (status != 0) throw Error(ErrorCode::internal, std::string("JPEG: ") + tjGetErrorStr2(jpeg.get()));
  return {reinterpret_cast<const char*>(out), n};
}

// Through sRGB's curve, by a table: within half a code of what a PNG has.
std::string encode_jpeg(const Picture& picture, const JpegOptions& options) {
  const auto& table = display_table();
  std::vector<unsigned char> bytes(picture.rgb.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    // Of NaN this makes 0, as in a PNG.
    const float value = std::min(std::max(0.0f, picture.rgb[i]), 1.0f);
    bytes[i] = table[static_cast<std::size_t>(value * kTable + 0.5f)];
  }
  return compress(bytes, picture.width, picture.height, false, options);
}

std::string encode_jpeg(const image::PngPixels& pixels, const JpegOptions& options) {
  std::vector<unsigned char> bytes(pixels.samples.size());
  const int shift = pixels.bits == 16 ? 8 : 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<unsigned char>(pixels.samples[i] >> shift);
  return compress(bytes, pixels.width, pixels.height, pixels.channels == 1, options);
}

std::vector<vec3> pixels_of(const Picture& picture) {
  std::vector<vec3> pixels(picture.rgb.size() / 3);
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  std::memcpy(pixels.data(), picture.rgb.data(), pixels.size() * sizeof(vec3));
  return pixels;
}

image::ChannelPicture channel_of(const Picture& picture) {
  std::vector<image::Channel> channels;
  for (const Channel& c : picture.channels) channels.push_back({c.name, c.values});
  const std::vector<image::ChannelPicture> pictures =
      image::channel_pictures(picture.width, picture.height, channels, pixels_of(picture));
  if (pictures.empty()) throw Error(ErrorCode::internal, "the channel was not rendered");
  return pictures.front();
}

}  // namespace

std::string as_jpeg(const Picture& picture, const RenderOptions& options, bool at_rest) {
  const JpegOptions jpeg = at_rest ? JpegOptions{92, true} : JpegOptions{78, false};
  if (options.channels.empty()) return encode_jpeg(picture, jpeg);
  return encode_jpeg(channel_of(picture).pixels, jpeg);
}

std::string as_png(const Picture& picture, const RenderOptions& options) {
  if (!options.channels.empty()) {
    const image::ChannelPicture channel = channel_of(picture);
    return image::encode_png(channel.pixels, channel.meta);
  }
  const image::Image image{picture.width, picture.height, pixels_of(picture)};
  return image::encode_picture(image::PictureFormat::png, image, {}, {});
}

}  // namespace kdray::view
