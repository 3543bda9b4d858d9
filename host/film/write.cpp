#include "film/write.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "film/channels.h"
#include "film/exr.h"
#include "film/format.h"
#include "film/png.h"
#include "film/transfer.h"

namespace kdray::film {
namespace fs = std::filesystem;
namespace {

PngPixels quantized(const Image& image, const Transfer& transfer, int bits) {
  PngPixels pixels{image.width, image.height, 3, bits, {}};
  pixels.samples.resize(3 * image.pixels.size());
  const Quantizer quantize(transfer, bits == 16 ? 65535 : 255);
  std::uint16_t* sample = pixels.samples.data();
  for (const vec3& p : image.pixels)
    for (int c = 0; c < 3; ++c) *sample++ = static_cast<std::uint16_t>(quantize(p[c]));
  return pixels;
}

// The name of a channel's own file: "a/out.png" and "depth" give "a/out.depth.png".
fs::path beside(const fs::path& file, const std::string& channel) {
  fs::path path = file;
  return path.replace_filename(file.stem().string() + "." + channel + file.extension().string());
}

void write_png(const fs::path& file, const Image& image, std::span<const Channel> channels,
               const WriteOptions& options, Written& written) {
  PngMeta meta;
  meta.color = options.transfer.srgb ? PngColor::srgb : PngColor::gamma;
  meta.gamma = options.transfer.gamma;
  write_file(file, encode_png(quantized(image, options.transfer, options.png_bits), meta));
  written.files.push_back(file);
  for (const ChannelPicture& picture : channel_pictures(image.width, image.height, channels)) {
    const fs::path path = beside(file, picture.name);
    write_file(path, encode_png(picture.pixels, picture.meta));
    written.files.push_back(path);
  }
}

std::size_t count_nan(const Image& image) {
  std::size_t n_nan = 0;
  for (const vec3& p : image.pixels)
    for (int c = 0; c < 3; ++c) n_nan += std::isnan(p[c]);
  return n_nan;
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
  for (const Channel& channel : channels)
    expect(channel.values.size() == n_pixels, "a channel does not fit the picture");
  check(options.transfer);
}

}  // namespace

Written write_picture(const fs::path& file, const Image& image, std::span<const Channel> channels,
                      const WriteOptions& options) {
  const PictureFormat format = format_for_writing(file);
  check_shape(image, channels, options);
  Written written;
  written.nan_values = count_nan(image);
  if (format == PictureFormat::png) {
    write_png(file, image, channels, options, written);
  } else {
    write_file(file, encode_exr(image, channels));
    written.files.push_back(file);
  }
  return written;
}

void check_picture_name(const fs::path& file) {
  format_for_writing(file);
  check_writable(file);
}

}  // namespace kdray::film
