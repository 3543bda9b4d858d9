#include "scene/textures/picture.h"

#include <algorithm>

#include "base/error.h"
#include "io/image/png.h"
#include "scene/textures/webp_picture.h"
#ifdef KDRAY_WITH_JPEG
#include <turbojpeg.h>
#endif

namespace kdray::scene {

namespace {

void check_size(std::uint64_t width, std::uint64_t height, const std::string& name) {
  if (width == 0 || height == 0) throw input_error(name, 0, "a picture without pixels", "write it again");
  if (width <= kLongestSide && height <= kLongestSide && width * height <= kMostTexels) return;
  throw input_error(name, 0,
                    "a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels; textures have " + std::to_string(kMostTexels) +
                        " at most, and no side over " + std::to_string(kLongestSide),
                    "make it smaller");
}

std::uint32_t big_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::uint8_t byte_of(std::uint32_t sample, int bits) {
  return static_cast<std::uint8_t>(bits == 16 ? (sample * 255 + 32767) / 65535 : sample);
}

// The size stands at bytes 16 to 23 of every PNG.
Picture decode_png(std::string_view bytes, const std::string& name) {
  if (bytes.size() >= 24) check_size(big_endian(bytes, 16), big_endian(bytes, 20), name);
  const image::PngPixels png = image::decode_png(bytes, name);
  Picture picture =
      blank_picture(name, static_cast<std::uint32_t>(png.width), static_cast<std::uint32_t>(png.height));
  const auto step = static_cast<std::size_t>(png.channels);
  const std::size_t n = std::size_t{picture.width} * picture.height;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t c = 0; c < 4; ++c)
      picture.texels[4 * i + c] = c < step ? byte_of(png.samples[step * i + c], png.bits) : std::uint8_t{255};
  return picture;
}

#ifdef KDRAY_WITH_JPEG
// Programs that write CMYK store how much of each ink is missing.
void rgb_from_cmyk(Array<std::uint8_t>& texels) {
  for (std::size_t i = 0; i + 3 < texels.size(); i += 4) {
    const std::uint32_t black = texels[i + 3];
    for (std::size_t c = 0; c < 3; ++c)
      texels[i + c] = static_cast<std::uint8_t>((texels[i + c] * black + 127) / 255);
    texels[i + 3] = 255;
  }
}

Picture decode_jpeg(std::string_view bytes, const std::string& name, std::vector<std::string>& warnings) {
  const std::unique_ptr<void, int (*)(tjhandle)> jpeg(tjInitDecompress(), tjDestroy);
  if (!jpeg) throw Error(ErrorCode::internal, "libjpeg-turbo can't be started");
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  const auto damaged = [&] {
    return input_error(name, 0, std::string("is a damaged JPEG: ") + tjGetErrorStr2(jpeg.get()),
                       "write it again");
  };
  int width = 0, height = 0, sampling = 0, colors = 0;
  if (tjDecompressHeader3(jpeg.get(), data, bytes.size(), &width, &height, &sampling, &colors) != 0)
    throw damaged();
  check_size(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), name);
  // A block of 64 pixels takes two bits at least.
  constexpr std::uint64_t kMostPerByte = 2048;
  if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > kMostPerByte * bytes.size())
    throw input_error(name, 0, "is a damaged JPEG: its header promises more pixels than it holds",
                      "write it again");
  const bool inks = colors == TJCS_CMYK || colors == TJCS_YCCK;
  Picture picture =
      blank_picture(name, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
  if (tjDecompress2(jpeg.get(), data, bytes.size(), picture.texels.data(), width, 0, height,
                    inks ? TJPF_CMYK : TJPF_RGBA, TJFLAG_ACCURATEDCT) != 0) {
    if (tjGetErrorCode(jpeg.get()) != TJERR_WARNING) throw damaged();
    warnings.push_back(name +
                       ": the JPEG is damaged, and shown as far as it goes: " + tjGetErrorStr2(jpeg.get()));
  }
  if (inks) rgb_from_cmyk(picture.texels);
  return picture;
}
#endif

}  // namespace

std::shared_ptr<const Picture> decode_picture(std::string_view bytes, const std::string& name,
                                              std::vector<std::string>& warnings) {
  if (bytes.starts_with("\x89PNG")) return std::make_shared<const Picture>(decode_png(bytes, name));
  if (bytes.starts_with("\xff\xd8")) {
#ifdef KDRAY_WITH_JPEG
    return std::make_shared<const Picture>(decode_jpeg(bytes, name, warnings));
#else
    throw input_error(name, 0, "is a JPEG, and kdray was built without libjpeg-turbo", "convert it to PNG");
#endif
  }
  if (is_webp(bytes)) return std::make_shared<const Picture>(decode_webp(bytes, name, check_size));
  (void)warnings;
  throw input_error(name, 0, "is neither PNG, JPEG nor WebP", "convert it to PNG");
}

}  // namespace kdray::scene
