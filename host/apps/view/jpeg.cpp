#include "apps/view/jpeg.h"

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "base/error.h"
#include "io/image/transfer.h"

namespace kdray::view {

namespace {

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

}  // namespace

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

}  // namespace kdray::view
