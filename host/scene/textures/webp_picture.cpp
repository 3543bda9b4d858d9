#include "scene/textures/webp_picture.h"

#include <algorithm>

#include "base/error.h"
#ifdef KDRAY_WITH_WEBP
#include <webp/decode.h>
#endif

namespace kdray::scene {

bool is_webp(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

#ifdef KDRAY_WITH_WEBP
Picture decode_webp(std::string_view bytes, const std::string& name,
                    void (*check_size)(std::uint64_t, std::uint64_t, const std::string&)) {
  const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const auto damaged = [&](const char* why) {
    return input_error(name, 0, std::string("is a damaged WebP: ") + why, "write it again");
  };
  WebPBitstreamFeatures header;
  if (WebPGetFeatures(data, bytes.size(), &header) != VP8_STATUS_OK)
    throw damaged("its header can't be read");
  if (header.has_animation)
    throw input_error(name, 0, "is an animated WebP", "convert one picture of it to PNG");
  const auto width = static_cast<std::uint64_t>(std::max(header.width, 0)),
             height = static_cast<std::uint64_t>(std::max(header.height, 0));
  check_size(width, height, name);
  if (width * height > std::max(kMostPixelsOfSmall, kMostPixelsPerByte * bytes.size()))
    throw damaged("its header promises more pixels than it holds");
  Picture picture =
      blank_picture(name, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
  if (!WebPDecodeRGBAInto(data, bytes.size(), picture.texels.data(), picture.texels.size(), 4 * header.width))
    throw damaged("it ends too early, or its pixels make no sense");
  return picture;
}
#else
Picture decode_webp(std::string_view, const std::string& name,
                    void (*)(std::uint64_t, std::uint64_t, const std::string&)) {
  throw input_error(name, 0, "is a WebP, and kdray was built without libwebp", "convert it to PNG");
}
#endif

}  // namespace kdray::scene
