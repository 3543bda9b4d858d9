#include "io/image/exr.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "pictures.h"
#include "support/errors.h"

namespace kdray::image {
namespace {

bool same_bits(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(vec3)) == 0;
}

TEST(Exr, KeepsEveryBit) {
  // Taller than one block of the reader, and no multiple of anything.
  Image image = noise(37, 531, 1, -1000, 1000);
  image.pixels[5] = vec3(INFINITY, -0.0f, 1e-42f);
  image.pixels[6].y = NAN;
  EXPECT_TRUE(same_bits(decode_exr(encode_exr(image, {}), "a.exr"), image));
}

TEST(Exr, CarriesChannelsUnderTheirUsualNames) {
  const Image image = noise(4, 3, 2);
  std::vector<Channel> channels;
  for (const char* name : {"depth", "normal.x", "normal.y", "normal.z", "primitive", "cost"})
    channels.push_back({name, std::vector<float>(12, 1.5f)});
  const std::string bytes = encode_exr(image, channels);
  // A channel list entry is its zero-ended name and 16 bytes that begin with the type, 2 for float.
  for (const char* name : {"Z", "N.X", "N.Y", "N.Z", "primitive", "cost"})
    EXPECT_NE(bytes.find(std::string("\0", 1) + name + std::string("\0\2\0\0\0", 5)), std::string::npos)
        << name;
  EXPECT_TRUE(same_bits(decode_exr(bytes, "a.exr"), image));
}

TEST(Exr, CarriesWhatTheNumbersOfAChannelAreCalled) {
  const Image image = noise(4, 3, 2);
  const std::vector<float> numbers(12, 1);
  const std::string manifest = R"({"lid":[[0,5]]})";
  const std::string bytes =
      encode_exr(image, std::vector<Channel>{{"primitive", numbers, manifest}, {"depth", numbers}});
  // An attribute is its zero-ended name, its zero-ended type, the length of its value, and that.
  std::string attribute("kdray/primitive/manifest\0string\0", 32);
  attribute += static_cast<char>(manifest.size()) + std::string(3, 0) + manifest;
  EXPECT_NE(bytes.find(attribute), std::string::npos);
  EXPECT_EQ(bytes.find("kdray/Z"), std::string::npos);
  EXPECT_TRUE(same_bits(decode_exr(bytes, "a.exr"), image));
}

// As compositing programs read it: the data window within the display window.
TEST(Exr, APartOfAPictureSaysWhereItLies) {
  Image part = noise(37, 53, 5);
  part.x = 200, part.y = 91, part.whole_width = 640, part.whole_height = 480;
  const std::string bytes = encode_exr(part, std::vector<Channel>{{"depth", std::vector<float>(37 * 53, 2)}});
  const auto window = [&bytes](const std::string& name) {
    const std::string entry = name + std::string("\0box2i\0\x10\0\0\0", 11);
    std::array<std::int32_t, 4> corners{};
    const std::size_t at = bytes.find(entry);
    EXPECT_NE(at, std::string::npos) << name;
    if (at != std::string::npos)
      std::memcpy(corners.data(), bytes.data() + at + entry.size(), sizeof corners);
    return corners;
  };
  EXPECT_EQ(window("dataWindow"), (std::array{200, 91, 236, 143}));
  EXPECT_EQ(window("displayWindow"), (std::array{0, 0, 639, 479}));
  EXPECT_TRUE(same_bits(decode_exr(bytes, "a.exr"), part));
}

TEST(Exr, EveryTruncationIsRefused) {
  const std::string whole = encode_exr(noise(9, 40, 3), {});
  // The last bytes are pixels: the reader must not return black for missing ones.
  for (std::size_t n = 0; n<whole.size(); n += n + 64> whole.size() ? 1 : 7)
    EXPECT_TRUE(test::fails([&] { decode_exr(whole.substr(0, n), "a.exr"); }, "a.exr: is ")) << n;
}

TEST(Exr, DamageNeverCrashes) {
  constexpr unsigned kSeed = 4;
  std::mt19937 random(kSeed);
  const std::string whole = encode_exr(noise(9, 40, 4), {});
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    // Mostly in the header, where the sizes are.
    for (unsigned k = random() % 4 + 1; k > 0; --k)
      bytes[random() % (random() % 4 ? 330u : bytes.size())] = static_cast<char>(random());
    try {
      decode_exr(bytes, "a.exr");
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << "seed " << kSeed;
    }
  }
}

TEST(Exr, AHeaderIsNotTrustedWithMemory) {
  std::string bytes = encode_exr(noise(8, 8, 5), {});
  const std::string window = "dataWindow";
  const std::size_t at = bytes.find(window) + window.size() + 1 + sizeof "box2i" + 4;
  const std::int32_t far = 60000;
  std::memcpy(bytes.data() + at + 8, &far, 4), std::memcpy(bytes.data() + at + 12, &far, 4);
  EXPECT_TRUE(test::fails([&] { decode_exr(bytes, "a.exr"); }, "damaged"));
}

// A name of the file's own, in a message of one line.
TEST(Exr, TellsOfChannelsInOneLine) {
  std::string bytes = encode_exr(noise(8, 8, 6), {});
  const std::string channels = "chlist";
  const std::size_t at = bytes.find(channels) + channels.size() + 1 + 4;
  ASSERT_EQ(bytes.substr(at, 2), std::string("B\0", 2));
  bytes[at] = '\n';
  EXPECT_TRUE(test::fails([&] { decode_exr(bytes, "a.exr"); },
                          "a.exr: has no channels R, G and B or Y (it has ?, G, R)"));
}

TEST(Exr, RefusesWhatIsNone) {
  EXPECT_TRUE(test::fails([] { decode_exr("not a picture", "a.exr"); }, "is not an OpenEXR file"));
}

}  // namespace
}  // namespace kdray::image
