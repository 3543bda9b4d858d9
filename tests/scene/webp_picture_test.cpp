// What    WebP pictures against the pixels that were packed: without loss they are the same, with loss
//         nearly; by glTF's EXT_texture_webp; damaged, cut short and with hostile headers.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"
#include "scene/gltf_samples.h"
#include "scene/import/load.h"
#include "scene/pictures.h"
#include "scene/scratch.h"
#include "scene/textures/picture.h"
#include "support/seed.h"
#ifdef KDRAY_WITH_WEBP
#include <webp/encode.h>
#endif

namespace kdray::scene {
namespace {

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

Picture decoded(const std::string& bytes) {
  std::vector<std::string> warnings;
  const Picture picture = *decode_picture(bytes, "a.webp", warnings);
  EXPECT_TRUE(warnings.empty());
  return picture;
}
std::string refused(const std::string& bytes) {
  return test::refusal([&] { decoded(bytes); });
}

// A textured square; the texture says where its picture is.
test::GltfSample square_with(const std::string& bytes, const nlohmann::json& texture) {
  test::GltfSample sample = test::square();
  sample.json["images"] = {{{"mimeType", "image/webp"}, {"bufferView", sample.view(bytes)}},
                           {{"uri", "data:image/png;base64," + test::base64(test::four_colors())}}};
  sample.json["textures"] = {texture};
  sample.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  sample.primitive()["material"] = 0;
  return sample;
}

nlohmann::json webp_source() {
  nlohmann::json texture;
  texture["extensions"]["EXT_texture_webp"] = {{"source", 0}};
  return texture;
}

#ifdef KDRAY_WITH_WEBP

constexpr int kWidth = 37, kHeight = 21;

std::vector<std::uint8_t> pixels(bool opaque) {
  std::vector<std::uint8_t> out;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (const int part : {x * 6, y * 11, x * y % 256, opaque ? 255 : 255 - x})
        out.push_back(static_cast<std::uint8_t>(part));
  return out;
}

std::string packed(const std::vector<std::uint8_t>& rgba, int width, int height, float quality) {
  std::uint8_t* to = nullptr;
  const std::size_t n = quality < 0 ? WebPEncodeLosslessRGBA(rgba.data(), width, height, 4 * width, &to)
                                    : WebPEncodeRGBA(rgba.data(), width, height, 4 * width, quality, &to);
  std::string out(reinterpret_cast<const char*>(to), n);
  WebPFree(to);
  return out;
}

TEST(WebpPicture, WithoutLossItIsTheSame) {
  for (const bool opaque : {true, false}) {
    const Picture picture = decoded(packed(pixels(opaque), kWidth, kHeight, -1));
    EXPECT_EQ(picture.width, std::uint32_t{kWidth});
    EXPECT_EQ(picture.height, std::uint32_t{kHeight});
    EXPECT_EQ(test::bytes_of(picture), pixels(opaque));
  }
}

TEST(WebpPicture, WithLossItIsNearlyTheSame) {
  const std::vector<std::uint8_t> even(std::size_t{4} * 64 * 64, 200);
  const Picture picture = decoded(packed(even, 64, 64, 95));
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_NEAR(picture.texels[i], even[i], 4);
}

TEST(WebpPicture, IsATextureOfGltf) {
  const std::string bytes = packed(pixels(true), kWidth, kHeight, -1);
  const Scene s = read_gltf(square_with(bytes, webp_source()).text(), "a.gltf");
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_EQ(test::bytes_of(*s.texturing.pictures[0]), pixels(true));
}

TEST(WebpPicture, DamagedOnesAreRefusedOrRead) {
  for (const float quality : {-1.0f, 60.0f}) {
    const std::string good = packed(pixels(false), kWidth, kHeight, quality);
    EXPECT_SAYS(refused(good.substr(0, good.size() / 2)), "a.webp: is a damaged WebP: ");
    EXPECT_SAYS(refused(good.substr(0, 14)), "a.webp: is a damaged WebP: its header can't be read");
    const unsigned seed = test::seed_or(28);
    std::mt19937 random(seed);
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (int round = 0; round < 4000; ++round) {
      std::string bad = good.substr(0, round % 3 == 0 ? random() % good.size() : good.size());
      for (unsigned i = 0; i <= random() % 3 && !bad.empty(); ++i)
        bad[random() % bad.size()] = static_cast<char>(random());
      try {
        std::vector<std::string> warnings;
        const auto picture = decode_picture(bad, "a.webp", warnings);
        EXPECT_EQ(picture->texels.size(), std::size_t{4} * picture->width * picture->height);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::input) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      }
    }
  }
}

// 14 bits for each side stand behind the signature of a picture without loss.
TEST(WebpPicture, SidesAreHeldAgainstTheBytes) {
  std::string bytes = packed(pixels(true), kWidth, kHeight, -1);
  const std::size_t at = bytes.find("VP8L") + 9;
  bytes[at] = static_cast<char>(0xff), bytes[at + 1] = static_cast<char>(0xff),
  bytes[at + 2] = static_cast<char>(0xff);
  bytes[at + 3] = static_cast<char>(bytes[at + 3] | 0x0f);
  EXPECT_SAYS(refused(bytes), "a picture of 16384x16384");
  bytes[at] = static_cast<char>(0xff), bytes[at + 1] = 0x1f, bytes[at + 2] = 0x7c,
  bytes[at + 3] = 0x07;  // 8192x7665
  EXPECT_SAYS(refused(bytes), "its header promises more pixels than it holds");
}

#else

TEST(WebpPicture, WithoutLibwebpItIsLeftOut) {
  const Scene s = read_gltf(square_with("RIFF1234WEBPVP8 ", webp_source()).text(), "a.gltf");
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "image 0: is a WebP, and kdray was built without libwebp; convert it to PNG");
}

#endif

// A texture with both names a PNG for those who don't read WebP.
TEST(WebpPicture, ThePngBesideItIsTaken) {
  nlohmann::json texture = webp_source();
  texture["source"] = 1;
  const Scene s = read_gltf(square_with("no picture", texture).text(), "a.gltf");
  EXPECT_TRUE(s.warnings.empty());
  ASSERT_EQ(s.texturing.pictures.size(), 1u);
  EXPECT_EQ(s.texturing.pictures[0]->width, 2u);
}

}  // namespace
}  // namespace kdray::scene
