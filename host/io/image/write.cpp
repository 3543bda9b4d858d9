#include "io/image/write.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "io/image/channels.h"
#include "io/image/exr.h"
#include "io/image/png.h"
#include "io/image/transfer.h"

namespace kdray::image {
namespace fs = std::filesystem;
namespace {

// A PNG's colour is not multiplied with its alpha; where nothing is covered it is black.
vec3 straight(const vec3& color, float alpha) {
  return alpha > 0 ? color / alpha : vec3(0);
}

PngPixels quantized(const Image& image, const Transfer& transfer, int bits) {
  const bool has_alpha = !image.alpha.empty();
  PngPixels pixels{image.width, image.height, has_alpha ? 4 : 3, bits, {}};
  pixels.samples.resize(static_cast<std::size_t>(pixels.channels) * image.pixels.size());
  const double maximum = bits == 16 ? 65535 : 255;
  const Quantizer quantize(transfer, bits == 16 ? 65535 : 255);
  std::uint16_t* sample = pixels.samples.data();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const vec3 color = has_alpha ? straight(image.pixels[i], image.alpha[i]) : image.pixels[i];
    for (int c = 0; c < 3; ++c) *sample++ = static_cast<std::uint16_t>(quantize(color[c]));
    if (has_alpha) *sample++ = static_cast<std::uint16_t>(std::lround(image.alpha[i] * maximum));
  }
  return pixels;
}

// The name of a channel's own file: "a/out.png" and "depth" give "a/out.depth.png".
fs::path beside(const fs::path& file, const std::string& channel) {
  fs::path path = file;
  return path.replace_filename(file.stem().string() + "." + channel + file.extension().string());
}

std::string encode_color(const Image& image, const WriteOptions& options) {
  PngMeta meta;
  meta.color = options.transfer.srgb ? PngColor::srgb : PngColor::gamma;
  meta.gamma = options.transfer.gamma;
  return encode_png(quantized(image, options.transfer, options.png_bits), meta);
}

void write_channels(const fs::path& file, const Image& image, std::span<const Channel> channels,
                    Written& written) {
  for (const ChannelPicture& picture : channel_pictures(image.width, image.height, channels, image.pixels)) {
    const fs::path path = beside(file, picture.name);
    write_file(path, encode_png(picture.pixels, picture.meta));
    written.files.push_back(path);
  }
}

void check_shape(const Image& image, std::span<const Channel> channels, const WriteOptions& options) {
  const auto expect = [](bool good, const char* what) {
    if (!good) throw Error(ErrorCode::internal, std::string("write_picture: ") + what);
  };
  const std::size_t n_pixels = image.pixels.size();
  expect(image.width > 0 && image.height > 0, "an empty picture");
  expect(n_pixels == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
         "pixels do not fit width and height");
  expect(options.png_bits == 8 || options.png_bits == 16, "png_bits is neither 8 nor 16");
  expect(image.alpha.empty() || image.alpha.size() == n_pixels, "alpha does not fit the picture");
  for (const Channel& channel : channels)
    expect(channel.values.size() == n_pixels, "a channel does not fit the picture");
  check(options.transfer);
}

}  // namespace

std::size_t count_nan(const Image& image) {
  std::size_t n_nan = 0;
  for (const vec3& p : image.pixels)
    for (int c = 0; c < 3; ++c) n_nan += std::isnan(p[c]);
  return n_nan;
}

std::string encode_picture(PictureFormat format, const Image& image, std::span<const Channel> channels,
                           const WriteOptions& options) {
  check_shape(image, channels, options);
  return format == PictureFormat::png ? encode_color(image, options) : encode_exr(image, channels);
}

Written write_picture(const fs::path& file, const Image& image, std::span<const Channel> channels,
                      const WriteOptions& options) {
  const PictureFormat format = options.format ? *options.format : format_for_writing(file);
  Written written;
  written.nan_values = count_nan(image);
  write_file(file, encode_picture(format, image, channels, options));
  written.files.push_back(file);
  if (format == PictureFormat::png) write_channels(file, image, channels, written);
  return written;
}

std::vector<fs::path> picture_files(const fs::path& file, std::span<const std::string> channels,
                                    const WriteOptions& options) {
  const PictureFormat format = options.format ? *options.format : format_for_writing(file);
  std::vector<fs::path> files = {file};
  if (format == PictureFormat::png)
    for (const std::string& channel : channels) files.push_back(beside(file, channel));
  return files;
}

}  // namespace kdray::image
