#include "io/image/png.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <cstring>
#include <fstream>
#include <random>

#include "io/image/picture_file.h"
#include "support/errors.h"
#include "support/folder.h"

namespace kdray::image {
namespace {

PngPixels random_pixels(int channels, int bits, unsigned seed) {
  std::mt19937 random(seed);
  PngPixels p{13, 7, channels, bits, {}};
  for (int i = 0; i < 13 * 7 * channels; ++i)
    p.samples.push_back(static_cast<std::uint16_t>(random() & (bits == 16 ? 65535 : 255)));
  return p;
}

// libpng's simplified writer as a second opinion, for kinds that encode_png does not write.
std::string write_simplified(png_uint_32 format, const void* pixels, const void* colormap = nullptr,
                             png_uint_32 n_colors = 0) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = 2, image.height = 1, image.format = format, image.colormap_entries = n_colors;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, pixels, 0, colormap);
  std::string bytes(size, '\0');
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, colormap))
      << image.message;
  bytes.resize(size);
  return bytes;
}

TEST(Png, ComesBackAsWritten) {
  for (const int bits : {8, 16}) {
    const PngPixels rgb = random_pixels(3, bits, 1);
    const PngPixels back = decode_png(encode_png(rgb, {}), "a.png");
    EXPECT_EQ(back.width, 13);
    EXPECT_EQ(back.height, 7);
    EXPECT_EQ(back.bits, bits);
    EXPECT_EQ(back.samples, rgb.samples);
  }
}

TEST(Png, GreyComesBackAsRgb) {
  for (const int bits : {8, 16}) {
    const PngPixels grey = random_pixels(1, bits, 2);
    const PngPixels back = decode_png(encode_png(grey, {}), "a.png");
    ASSERT_EQ(back.samples.size(), 3 * grey.samples.size());
    for (std::size_t i = 0; i < back.samples.size(); ++i) EXPECT_EQ(back.samples[i], grey.samples[i / 3]);
  }
}

TEST(Png, KeepsAlphaAndExpandsPalettes) {
  const unsigned char rgba[] = {10, 20, 30, 128, 40, 50, 60, 255};
  const std::vector<std::uint16_t> wanted = {10, 20, 30, 40, 50, 60};
  EXPECT_EQ(decode_png(write_simplified(PNG_FORMAT_RGBA, rgba), "a.png").samples,
            (std::vector<std::uint16_t>{10, 20, 30, 128, 40, 50, 60, 255}));
  const unsigned char grey_alpha[] = {10, 128, 40, 255};
  EXPECT_EQ(decode_png(write_simplified(PNG_FORMAT_GA, grey_alpha), "a.png").samples,
            (std::vector<std::uint16_t>{10, 10, 10, 128, 40, 40, 40, 255}));
  const unsigned char index[] = {1, 0}, colors[] = {40, 50, 60, 10, 20, 30};
  EXPECT_EQ(decode_png(write_simplified(PNG_FORMAT_RGB_COLORMAP, index, colors, 2), "a.png").samples, wanted);
}

TEST(Png, SaysHowItsNumbersAreMeant) {
  const PngPixels pixels = random_pixels(3, 8, 3);
  const std::string srgb = encode_png(pixels, {PngColor::srgb, 1, ""});
  const std::string gamma = encode_png(pixels, {PngColor::gamma, 2, ""});
  const std::string data = encode_png(pixels, {PngColor::data, 1, "depth: 1 to 2"});
  EXPECT_NE(srgb.find("sRGB"), std::string::npos);
  EXPECT_EQ(gamma.find("sRGB"), std::string::npos);
  // gAMA holds 100000 / gamma, big endian.
  const std::size_t at = gamma.find("gAMA");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(gamma.substr(at + 4, 4), std::string("\x00\x00\xc3\x50", 4));
  EXPECT_EQ(data.find("gAMA"), std::string::npos);
  EXPECT_NE(data.find("depth: 1 to 2"), std::string::npos);
}

TEST(Png, IsTheSameBytesEachTime) {
  const PngPixels pixels = random_pixels(3, 8, 4);
  EXPECT_EQ(encode_png(pixels, {PngColor::srgb, 1, ""}), encode_png(pixels, {PngColor::srgb, 1, ""}));
}

TEST(Png, EveryTruncationIsRefused) {
  const std::string whole = encode_png(random_pixels(3, 8, 5), {});
  for (std::size_t n = 0; n < whole.size(); ++n)
    EXPECT_TRUE(test::fails([&] { decode_png(whole.substr(0, n), "a.png"); }, "a.png: is ")) << n;
}

TEST(Png, DamageNeverCrashes) {
  constexpr unsigned kSeed = 6;
  std::mt19937 random(kSeed);
  const std::string whole = encode_png(random_pixels(3, 16, 6), {PngColor::srgb, 1, "x"});
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    for (unsigned k = random() % 4 + 1; k > 0; --k)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      decode_png(bytes, "a.png");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << "seed " << kSeed;
    }
  }
}

TEST(Png, AHeaderIsNotTrustedWithMemory) {
  std::string bytes = encode_png(random_pixels(3, 8, 7), {});
  const unsigned char huge[] = {0, 0x0f, 0x42, 0x40, 0, 0x0f, 0x42, 0x40};  // a million squared: 3 TB
  std::memcpy(bytes.data() + 16, huge, 8);
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + 12), 17);
  for (int i = 0; i < 4; ++i)
    bytes[29 + static_cast<std::size_t>(i)] = static_cast<char>(crc >> (24 - 8 * i));
  EXPECT_TRUE(test::fails([&] { decode_png(bytes, "a.png"); }, "promises more pixels"));
}

// Of this process, in bytes: also what was allocated and never touched.
std::uint64_t most_address_space() {
  std::ifstream status("/proc/self/status");
  std::uint64_t kib = 0;
  for (std::string word; status >> word && word != "VmPeak:";) continue;
  status >> kib;
  return kib << 10;
}

TEST(Png, AChunkIsNotTrustedWithMemory) {
  constexpr std::size_t kBehindHeader = 33;
  std::string bytes = encode_png(random_pixels(3, 8, 7), {});
  bytes.insert(kBehindHeader, std::string("\x7f\0\0\0tEXt", 8));  // two gigabytes
  const std::uint64_t before = most_address_space();
  ASSERT_GT(before, 0u);
  EXPECT_TRUE(test::fails([&] { decode_png(bytes, "a.png"); }, "cut short"));
  EXPECT_LT(most_address_space() - before, std::uint64_t{1} << 30);
}

TEST(ReadPicture, SaysWhatIsWrong) {
  const test::Folder folder;
  folder.put("a.png", "GIF89a and so on, long enough to have a header");
  EXPECT_TRUE(test::fails([&] { read_picture(folder / "a.png", {}); }, "neither a PNG nor an OpenEXR"));
  EXPECT_TRUE(test::fails([&] { read_picture(folder / "none.png", {}); }, "No such file"));
  EXPECT_TRUE(test::fails([&] { read_picture(folder.path(), {}); }, "is a folder"));
}

}  // namespace
}  // namespace kdray::image
