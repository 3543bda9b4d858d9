#include "apps/view/pixels.h"

#include <cstring>

#include "apps/view/jpeg.h"
#include "io/image/channels.h"
#include "io/image/png.h"
#include "io/image/write.h"

namespace kdray::view {

namespace {

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
