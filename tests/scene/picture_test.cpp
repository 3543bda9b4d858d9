// Pictures of textures in every form that files have, and in none that decoders may be made to trip over.
#include "scene/textures/picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <csetjmp>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "support/seed.h"
#ifdef KDRAY_WITH_JPEG
#include <turbojpeg.h>
#endif

namespace kdray::scene {
namespace {

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

using Bytes = std::vector<std::uint8_t>;

std::shared_ptr<const Picture> decode(const std::string& bytes) {
  std::vector<std::string> warnings;
  auto picture = decode_picture(bytes, "p", warnings);
  EXPECT_TRUE(warnings.empty());
  return picture;
}

std::string refused(const std::string& bytes) {
  return test::refusal([&] {
    std::vector<std::string> warnings;
    decode_picture(bytes, "p", warnings);
  });
}

// Through libpng itself, for the forms that kdray doesn't write: a row's bytes as they lie in the file.
std::string png_of(png_uint_32 width, png_uint_32 height, int bits, int color, const Bytes& rows,
                   int interlace = PNG_INTERLACE_NONE, const std::vector<png_color>& palette = {},
                   const Bytes& palette_alpha = {}) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep data, png_size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), n);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, bits, color, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  png_set_check_for_invalid_index(png, 0);  // pixels may have colours that the palette lacks
  if (!palette_alpha.empty())
    png_set_tRNS(png, info, palette_alpha.data(), static_cast<int>(palette_alpha.size()), nullptr);
  png_write_info(png, info);
  std::vector<png_bytep> pointers;
  Bytes copy = rows;
  for (png_uint_32 y = 0; y < height; ++y) pointers.push_back(copy.data() + y * (copy.size() / height));
  png_write_image(png, pointers.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

TEST(Picture, OfOnePixel) {
  const auto p = decode(test::png(1, 1, 4, {1, 2, 3, 4}));
  EXPECT_EQ(p->width, 1u);
  EXPECT_EQ(test::bytes_of(*p), (Bytes{1, 2, 3, 4}));
}

TEST(Picture, OfSixteenBitsIsRounded) {
  EXPECT_EQ(test::bytes_of(*decode(test::png(1, 2, 3, {0, 65535, 128, 129, 32768, 386}, 16))),
            (Bytes{0, 255, 0, 255, 1, 128, 2, 255}));
}

TEST(Picture, OfGreyWithAlpha) {
  EXPECT_EQ(test::bytes_of(*decode(png_of(2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {9, 200, 8, 100}))),
            (Bytes{9, 9, 9, 200, 8, 8, 8, 100}));
  EXPECT_EQ(test::bytes_of(*decode(png_of(3, 1, 1, PNG_COLOR_TYPE_GRAY, {0xa0}))),
            (Bytes{255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255}));
}

TEST(Picture, OfAPaletteWithAlpha) {
  const auto p = decode(png_of(4, 1, 2, PNG_COLOR_TYPE_PALETTE, {0x1b}, PNG_INTERLACE_NONE,
                               {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}}, {0, 128}));
  EXPECT_EQ(test::bytes_of(*p), (Bytes{1, 2, 3, 0, 4, 5, 6, 128, 7, 8, 9, 255, 10, 11, 12, 255}));
}

TEST(Picture, InterlacedIsTheSame) {
  Bytes rows(13 * 9 * 3);
  std::mt19937 random(5);
  for (auto& b : rows) b = static_cast<std::uint8_t>(random());
  const auto plain = decode(png_of(13, 9, 8, PNG_COLOR_TYPE_RGB, rows));
  const auto interlaced = decode(png_of(13, 9, 8, PNG_COLOR_TYPE_RGB, rows, PNG_INTERLACE_ADAM7));
  EXPECT_EQ(test::bytes_of(*plain), test::bytes_of(*interlaced));
}

TEST(Picture, RefusesWhatIsNone) {
  EXPECT_SAYS(refused(""), "p: is neither PNG, JPEG nor WebP");
  EXPECT_SAYS(refused("GIF89a"), "is neither PNG, JPEG nor WebP");
  EXPECT_SAYS(refused("\x89PNG"), "is not a PNG");
  const std::string good = test::four_colors();
  EXPECT_SAYS(refused(good.substr(0, good.size() - 20)), "damaged PNG");
}

// Nothing is allocated for pixels that aren't there.
TEST(Picture, RefusesWhatIsHuge) {
  std::string huge = test::four_colors();
  const auto set = [&](std::size_t at, std::uint32_t v) {
    for (std::size_t i = 0; i < 4; ++i) huge[at + i] = static_cast<char>(v >> (24 - 8 * i));
  };
  set(16, 40000);
  EXPECT_SAYS(refused(huge), "a picture of 40000x2 pixels; textures have");
  set(16, 16384), set(20, 16384);
  EXPECT_SAYS(refused(huge), "16384x16384");
  set(16, 0);
  EXPECT_SAYS(refused(huge), "without pixels");
}

void expect_safe(const std::string& bytes) {
  std::vector<std::string> warnings;
  try {
    const auto p = decode_picture(bytes, "p", warnings);
    EXPECT_EQ(p->texels.size(), std::size_t{4} * p->width * p->height);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
  }
  for (const std::string& w : warnings) EXPECT_EQ(w.find('\n'), std::string::npos) << w;
}

void mutate(const std::string& good, unsigned usual) {
  const unsigned seed = test::seed_or(usual);
  SCOPED_TRACE(seed);
  for (std::size_t n = 0; n < good.size(); ++n) expect_safe(good.substr(0, n));
  std::mt19937 random(seed);
  for (int round = 0; round < 4000; ++round) {
    std::string bad = good;
    for (unsigned i = 1 + random() % 4; i > 0; --i) bad[random() % bad.size()] = static_cast<char>(random());
    expect_safe(bad);
  }
}

TEST(Picture, DamagedPngIsALine) {
  Bytes rows(13 * 9 * 4, 77);
  mutate(png_of(13, 9, 8, PNG_COLOR_TYPE_RGB_ALPHA, rows, PNG_INTERLACE_ADAM7), 6);
  mutate(png_of(4, 1, 2, PNG_COLOR_TYPE_PALETTE, {0x1b}, PNG_INTERLACE_NONE, {{1, 2, 3}, {4, 5, 6}}, {0}), 7);
  mutate(test::png(3, 2, 3, std::vector<std::uint16_t>(18, 300), 16), 8);
}

#ifdef KDRAY_WITH_JPEG
std::string jpeg_of(int width, int height, int format, int sampling, const Bytes& pixels, int flags = 0) {
  const tjhandle jpeg = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long n = 0;
  EXPECT_EQ(tjCompress2(jpeg, pixels.data(), width, 0, height, format, &out, &n, sampling, 98, flags), 0);
  const std::string bytes(reinterpret_cast<const char*>(out), n);
  tjFree(out);
  tjDestroy(jpeg);
  return bytes;
}

void expect_near(const Picture& p, const Bytes& color, int bound) {
  for (std::size_t i = 0; i < p.texels.size(); ++i) ASSERT_NEAR(p.texels[i], color[i % 4], bound) << i;
}

TEST(Picture, OfJpeg) {
  const Bytes pixels = [] {
    Bytes all;
    for (int i = 0; i < 20 * 11; ++i) all.insert(all.end(), {200, 100, 50});
    return all;
  }();
  for (const int sampling : {TJSAMP_444, TJSAMP_420, TJSAMP_422})
    for (const int flags : {0, TJFLAG_PROGRESSIVE})
      expect_near(*decode(jpeg_of(20, 11, TJPF_RGB, sampling, pixels, flags)), {200, 100, 50, 255}, 2);
  expect_near(*decode(jpeg_of(5, 5, TJPF_GRAY, TJSAMP_GRAY, Bytes(25, 90))), {90, 90, 90, 255}, 1);
}

// How much of each ink is missing, times how much of the black.
TEST(Picture, OfJpegInFourInks) {
  Bytes pixels;
  for (int i = 0; i < 16 * 16; ++i) pixels.insert(pixels.end(), {255, 128, 0, 128});
  expect_near(*decode(jpeg_of(16, 16, TJPF_CMYK, TJSAMP_444, pixels)), {128, 64, 0, 255}, 3);
}

TEST(Picture, OfAJpegThatIsCutShortIsShownAsFarAsItGoes) {
  Bytes pixels(64 * 64 * 3);
  std::mt19937 random(9);
  for (auto& b : pixels) b = static_cast<std::uint8_t>(random());
  const std::string whole = jpeg_of(64, 64, TJPF_RGB, TJSAMP_444, pixels);
  std::vector<std::string> warnings;
  const auto p = decode_picture(whole.substr(0, whole.size() / 2), "p", warnings);
  EXPECT_EQ(p->width, 64u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_SAYS(warnings[0], "p: the JPEG is damaged, and shown as far as it goes");
}

TEST(Picture, DamagedJpegIsALine) {
  Bytes pixels(24 * 17 * 3);
  std::mt19937 random(10);
  for (auto& b : pixels) b = static_cast<std::uint8_t>(random() % 90);
  mutate(jpeg_of(24, 17, TJPF_RGB, TJSAMP_420, pixels), 11);
  mutate(jpeg_of(24, 17, TJPF_RGB, TJSAMP_422, pixels, TJFLAG_PROGRESSIVE), 12);
  mutate(jpeg_of(8, 8, TJPF_CMYK, TJSAMP_444, Bytes(256, 70)), 13);
}
#endif

}  // namespace
}  // namespace kdray::scene
