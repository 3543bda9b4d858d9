// What    Defines encode_png. libpng reports errors with longjmp, which skips destructors: between setjmp and
//         the end of encode_rows only plain variables live, everything else belongs to the caller.
#include <png.h>

#include <csetjmp>

#include "base/error.h"
#include "io/image/png.h"
#include "io/image/png_errors.h"

namespace kdray::image {
namespace {

struct Sink {
  std::string bytes;
  std::string error;
  bool out_of_memory = false;
};

void append(png_structp png, png_bytep data, png_size_t n_bytes) {
  auto* sink = static_cast<Sink*>(png_get_io_ptr(png));
  try {
    sink->bytes.append(reinterpret_cast<const char*>(data), n_bytes);
  } catch (const std::bad_alloc&) {
    sink->out_of_memory = true;
  }
  if (sink->out_of_memory) png_error(png, "out of memory");
}

void flush(png_structp) {}

void set_color(png_structp png, png_infop info, const PngMeta& meta) {
  // png_set_sRGB_gAMA_and_cHRM adds what readers that do not know the sRGB chunk need.
  if (meta.color == PngColor::srgb) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (meta.color == PngColor::gamma) png_set_gAMA(png, info, 1 / meta.gamma);
}

void set_comment(png_structp png, png_infop info, const char* comment) {
  png_text text = {};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = const_cast<char*>("Comment");
  text.text = const_cast<char*>(comment);
  png_set_text(png, info, &text, 1);
}

// PNG wants its numbers big-endian.
void pack_row(const std::uint16_t* samples, std::size_t n_samples, int bits, png_bytep row) {
  for (std::size_t i = 0; i < n_samples; ++i) {
    if (bits == 16) *row++ = static_cast<png_byte>(samples[i] >> 8);
    *row++ = static_cast<png_byte>(samples[i]);
  }
}

int color_type(int channels) {
  if (channels == 4) return PNG_COLOR_TYPE_RGB_ALPHA;
  return channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB;
}

bool encode_rows(png_structp png, png_infop info, const PngPixels& picture, const PngMeta& meta, Sink& sink,
                 png_bytep row) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &sink, append, flush);
  // Measured on rendered pictures: this is three times as fast as what libpng chooses itself, for 2 to 6%
  // more bytes.
  png_set_compression_level(png, 3);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height),
               picture.bits, color_type(picture.channels), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  set_color(png, info, meta);
  if (!meta.comment.empty()) set_comment(png, info, meta.comment.c_str());
  png_write_info(png, info);
  const std::size_t n_samples = static_cast<std::size_t>(picture.width) * picture.channels;
  for (int y = 0; y < picture.height; ++y) {
    pack_row(picture.samples.data() + y * n_samples, n_samples, picture.bits, row);
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return true;
}

}  // namespace

std::string encode_png(const PngPixels& picture, const PngMeta& meta) {
  Sink sink;
  std::vector<png_byte> row(static_cast<std::size_t>(picture.width) * picture.channels * picture.bits / 8);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, keep_error<Sink>, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool good = info && encode_rows(png, info, picture, meta, sink, row.data());
  png_destroy_write_struct(&png, &info);
  if (!good && (sink.out_of_memory || sink.error.empty())) throw std::bad_alloc();
  if (!good) throw Error(ErrorCode::internal, "libpng could not encode the picture: " + sink.error);
  return std::move(sink.bytes);
}

}  // namespace kdray::image
