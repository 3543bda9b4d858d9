#include "scene/textures/picture.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/image/png.h"

#ifdef KDRAY_WITH_JPEG
#include <turbojpeg.h>
#endif
#ifdef KDRAY_WITH_WEBP
#include <webp/decode.h>
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

// Decodes a PNG, whose size stands at bytes 16 to 23.
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

// WebP, which glTF has by EXT_texture_webp. The most pixels for a file's bytes: an evenly coloured picture
// takes hardly any.
constexpr std::uint64_t kMostPixelsPerByte = 8192, kMostPixelsOfSmall = std::uint64_t{1} << 24;

bool is_webp(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

#ifdef KDRAY_WITH_WEBP
Picture decode_webp(std::string_view bytes, const std::string& name) {
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
Picture decode_webp(std::string_view, const std::string& name) {
  throw input_error(name, 0, "is a WebP, and kdray was built without libwebp", "convert it to PNG");
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
  if (is_webp(bytes)) return std::make_shared<const Picture>(decode_webp(bytes, name));
  (void)warnings;
  throw input_error(name, 0, "is neither PNG, JPEG nor WebP", "convert it to PNG");
}

namespace {

std::size_t n_texels(const Picture& p) {
  return std::size_t{p.width} * p.height;
}

const std::uint8_t* texel(const Picture& p, std::uint32_t x, std::uint32_t y) {
  return p.texels.data() + 4 * (std::size_t{y} * p.width + x);
}

bool has_alpha(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i)
    if (p.texels[4 * i + 3] != 255) return true;
  return false;
}

std::uint8_t byte_of_unit(double v) {
  return static_cast<std::uint8_t>(std::lround((v + 1) / 2 * 255));
}

}  // namespace

bool is_grey(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i) {
    const std::uint8_t* t = p.texels.data() + 4 * i;
    if (t[0] != t[1] || t[1] != t[2]) return false;
  }
  return true;
}

std::shared_ptr<const Picture> normals_of_heights(const Picture& heights, double strength) {
  Picture out = blank_picture(heights.name, heights.width, heights.height);
  std::uint8_t* to = out.texels.data();
  const std::uint32_t w = heights.width, h = heights.height;
  for (std::uint32_t y = 0; y < h; ++y)
    for (std::uint32_t x = 0; x < w; ++x) {
      const auto slope = [&](const std::uint8_t* before, const std::uint8_t* behind) {
        return strength * (int{*behind} - int{*before}) / (2 * 255.0);
      };
      const double across = slope(texel(heights, (x + w - 1) % w, y), texel(heights, (x + 1) % w, y));
      const double down = slope(texel(heights, x, (y + h - 1) % h), texel(heights, x, (y + 1) % h));
      const double length = std::sqrt(1 + across * across + down * down);
      // Green points up in the picture, against the way in which rows follow each other.
      for (const std::uint8_t byte : {byte_of_unit(-across / length), byte_of_unit(down / length),
                                      byte_of_unit(1 / length), std::uint8_t{255}})
        *to++ = byte;
    }
  return std::make_shared<const Picture>(std::move(out));
}

std::shared_ptr<const Picture> with_alpha(const Picture* colors, const Picture& alpha) {
  const Picture& base = colors ? *colors : alpha;
  Picture out = blank_picture(base.name, base.width, base.height);
  if (colors)
    std::copy(base.texels.begin(), base.texels.end(), out.texels.begin());
  else
    std::fill(out.texels.begin(), out.texels.end(), std::uint8_t{255});
  const std::size_t channel = has_alpha(alpha) ? 3 : 0;
  for (std::uint32_t y = 0; y < out.height; ++y)
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const auto nearest = [](std::uint32_t i, std::uint32_t n, std::uint32_t of) {
        return static_cast<std::uint32_t>((2 * std::uint64_t{i} + 1) * of / (2 * std::uint64_t{n}));
      };
      out.texels[4 * (std::size_t{y} * out.width + x) + 3] =
          texel(alpha, nearest(x, out.width, alpha.width), nearest(y, out.height, alpha.height))[channel];
    }
  return std::make_shared<const Picture>(std::move(out));
}

bool is_cut_out(const Picture& p) {
  for (std::size_t i = 0; i < n_texels(p); ++i)
    if (p.texels[4 * i + 3] != 0 && p.texels[4 * i + 3] != 255) return false;
  return true;
}

}  // namespace kdray::scene
