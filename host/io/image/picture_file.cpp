#include "io/image/picture_file.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <set>
#include <string>

#include "base/error.h"
#include "io/image/channels.h"
#include "io/image/color.h"
#include "io/image/exr.h"
#include "io/image/png.h"

namespace kdray::image {

PictureFormat format_for_writing(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(status) || file.filename().empty())
    throw input_error(file.string(), 0, "is a folder",
                      "name a picture in it, as in " + (file / "picture.png").string());
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (ending == ".png") return PictureFormat::png;
  if (ending == ".exr") return PictureFormat::exr;
  if (ending.empty() && std::filesystem::is_other(status)) return PictureFormat::png;  // a pipe or device
  throw input_error(file.string(), 0,
                    ending.empty() ? "the picture's name has no ending"
                                   : "pictures of the kind '" + ending + "' cannot be written",
                    "end the name in .png or .exr");
}

PictureFormat format_of_content(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.starts_with("\x89PNG")) return PictureFormat::png;
  if (bytes.starts_with("\x76\x2f\x31\x01")) return PictureFormat::exr;
  throw input_error(file.string(), 0, "is neither a PNG nor an OpenEXR picture", "name a .png or .exr file");
}

namespace fs = std::filesystem;
namespace {

// Divides a colour by its alpha, since a PNG's colour is not multiplied with it; where nothing is covered it
// is black.
vec3 straight(const vec3& color, float alpha) {
  return alpha > 0 ? color / alpha : vec3(0);
}

PngPixels quantized(const Image& image, const WriteOptions& options) {
  const bool has_alpha = !image.alpha.empty();
  const int bits = options.png_bits;
  PngPixels pixels{image.width, image.height, has_alpha ? 4 : 3, bits, {}};
  pixels.samples.resize(static_cast<std::size_t>(pixels.channels) * image.pixels.size());
  const double maximum = bits == 16 ? 65535 : 255;
  const auto brighter = static_cast<float>(std::exp2(options.exposure));
  const Quantizer quantize(options.transfer, bits == 16 ? 65535 : 255);
  std::uint16_t* sample = pixels.samples.data();
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const vec3 color = has_alpha ? straight(image.pixels[i], image.alpha[i]) : image.pixels[i];
    for (int c = 0; c < 3; ++c) *sample++ = static_cast<std::uint16_t>(quantize(color[c] * brighter));
    if (has_alpha) *sample++ = static_cast<std::uint16_t>(std::lround(image.alpha[i] * maximum));
  }
  return pixels;
}

// Returns the name of a channel's own file: "a/out.png" and "depth" give "a/out.depth.png".
fs::path beside(const fs::path& file, const std::string& channel) {
  fs::path path = file;
  return path.replace_filename(file.stem().string() + "." + channel + file.extension().string());
}

std::string encode_color(const Image& image, const WriteOptions& options) {
  PngMeta meta;
  meta.color = options.transfer.srgb ? PngColor::srgb : PngColor::gamma;
  meta.gamma = options.transfer.gamma;
  return encode_png(quantized(image, options), meta);
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
  expect(std::abs(options.exposure) <= 100, "exposure is not from -100 to 100");
  check(options.transfer);
}

// In an EXR a channel stands beside the colour, and beside a PNG it is a part of a file's name.
void check_names(const fs::path& file, PictureFormat format, std::span<const Channel> channels) {
  const bool is_exr = format == PictureFormat::exr;
  std::set<std::string> names = {""};
  if (is_exr) names.insert({"R", "G", "B", "A"});
  for (const Channel& channel : channels)
    if (!names.insert(is_exr ? exr_name(channel.name) : channel.name).second ||
        channel.name.find('/') != std::string::npos)
      throw input_error(file.string(), 0, "a channel can't have the name '" + channel.name + "'",
                        "give each one of its own that is no colour's");
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
  check_names(file, format, channels);
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

namespace {

std::string read_bytes(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error))
    throw input_error(file.string(), 0, "is a folder", "name a picture in it");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"), std::fclose);
  if (!stream)
    throw input_error(file.string(), 0, std::string("cannot be opened: ") + std::strerror(errno),
                      "check its name");
  std::string bytes;
  char block[1 << 16];
  while (const std::size_t n_read = std::fread(block, 1, sizeof block, stream.get()))
    bytes.append(block, n_read);
  if (std::ferror(stream.get()))
    throw input_error(file.string(), 0, "cannot be read to its end", "check the disk");
  return bytes;
}

Image to_linear(const PngPixels& png, const Transfer& transfer) {
  check(transfer);
  const int maximum = png.bits == 16 ? 65535 : 255;
  std::vector<float> linear(static_cast<std::size_t>(maximum) + 1);
  for (int code = 0; code <= maximum; ++code)
    linear[static_cast<std::size_t>(code)] =
        static_cast<float>(decode(transfer, static_cast<double>(code) / maximum));
  Image image{png.width, png.height, {}};
  const auto step = static_cast<std::size_t>(png.channels);
  image.pixels.reserve(png.samples.size() / step);
  for (std::size_t i = 0; i + 2 < png.samples.size(); i += step)
    image.pixels.emplace_back(linear[png.samples[i]], linear[png.samples[i + 1]], linear[png.samples[i + 2]]);
  if (png.channels < 4) return image;
  image.alpha.reserve(image.pixels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const float alpha = static_cast<float>(png.samples[4 * i + 3]) / static_cast<float>(maximum);
    image.alpha.push_back(alpha);
    image.pixels[i] *= alpha;
  }
  return image;
}

}  // namespace

Image read_picture(const fs::path& file, const Transfer& transfer) {
  const std::string bytes = read_bytes(file);
  if (format_of_content(bytes, file) == PictureFormat::exr) return decode_exr(bytes, file.string());
  return to_linear(decode_png(bytes, file.string()), transfer);
}

}  // namespace kdray::image
