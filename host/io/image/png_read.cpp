// What    Defines decode_png. The pixels are allocated only after the header's size has been held against the
//         bytes that are there: Deflate can't expand by more than 1032 to 1. As in png_write.cpp, only plain
//         variables live across setjmp.
#include <png.h>

#include <csetjmp>
#include <cstring>

#include "base/error.h"
#include "io/image/png.h"
#include "io/image/png_errors.h"

namespace kdray::image {
namespace {

constexpr double kDeflateLimit = 1032;

struct Source {
  std::string_view bytes;
  std::size_t position = 0;
  std::string error;
};

void take(png_structp png, png_bytep data, png_size_t n_bytes) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (n_bytes > source->bytes.size() - source->position) png_error(png, "the file is cut short");
  std::memcpy(data, source->bytes.data() + source->position, n_bytes);
  source->position += n_bytes;
}

struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// Reads the header and sets the transformations; the rows that follow are RGB, or RGB and alpha, with 8 or 16
// bits.
bool start(png_structp png, png_infop info, Source& source) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, &source, take);
  png_read_info(png, info);
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_rows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

// How many bytes the picture's data are after inflating, before palette and grey are widened.
double stored_bytes(png_structp png, png_infop info, int bits_per_pixel) {
  return static_cast<double>(png_get_image_width(png, info)) * bits_per_pixel / 8 *
         png_get_image_height(png, info);
}

PngPixels unpack(const Reader& reader, const std::vector<png_byte>& raw) {
  PngPixels picture;
  picture.width = static_cast<int>(png_get_image_width(reader.png, reader.info));
  picture.height = static_cast<int>(png_get_image_height(reader.png, reader.info));
  picture.bits = png_get_bit_depth(reader.png, reader.info);
  picture.channels = png_get_channels(reader.png, reader.info);
  picture.samples.resize(static_cast<std::size_t>(picture.width) * picture.height * picture.channels);
  for (std::size_t i = 0; i < picture.samples.size(); ++i)
    picture.samples[i] =
        picture.bits == 16 ? static_cast<std::uint16_t>(raw[2 * i] << 8 | raw[2 * i + 1]) : raw[i];
  return picture;
}

}  // namespace

PngPixels decode_png(std::string_view bytes, const std::string& file) {
  const auto damaged = [&](const std::string& why) {
    return input_error(file, 0, "is a damaged PNG: " + why, "write it again");
  };
  if (bytes.size() < 26 || png_sig_cmp(reinterpret_cast<png_const_bytep>(bytes.data()), 0, 8) != 0)
    throw input_error(file, 0, "is not a PNG file", "name a PNG or EXR picture");
  Source source{bytes, 0, {}};
  Reader reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, keep_error<Source>, ignore_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();
  if (!start(reader.png, reader.info, source)) throw damaged(source.error);

  // Bit depth and colour type stand at bytes 24 and 25 of every PNG; libpng has replaced its own copies by
  // now.
  static constexpr int kChannels[] = {1, 0, 3, 1, 2, 0, 4};
  const int bits_per_pixel = bytes[24] * kChannels[static_cast<unsigned char>(bytes[25]) % 7];
  if (stored_bytes(reader.png, reader.info, bits_per_pixel) >
      kDeflateLimit * static_cast<double>(bytes.size()))
    throw damaged("its header promises more pixels than it holds");
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const std::size_t n_rows = png_get_image_height(reader.png, reader.info);
  std::vector<png_byte> raw(row_bytes * n_rows);
  std::vector<png_bytep> rows(n_rows);
  for (std::size_t y = 0; y < n_rows; ++y) rows[y] = raw.data() + y * row_bytes;
  if (!read_rows(reader.png, rows.data())) throw damaged(source.error);
  return unpack(reader, raw);
}

}  // namespace kdray::image
