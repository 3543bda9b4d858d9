#include "io/image/read.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.h"
#include "io/image/exr.h"
#include "io/image/format.h"
#include "io/image/png.h"
#include "io/image/transfer.h"

namespace kdray::image {
namespace fs = std::filesystem;
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
