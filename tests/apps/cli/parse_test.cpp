// What    The values of options, in the library: what is taken whole, what is refused.
#include "apps/cli/options.h"

#include <array>
#include <random>

#include "support/errors.h"

namespace kdray::cli {
namespace {

using test::fails;

TEST(Parse, SizesHaveTwoSidesAndALimit) {
  const Size size = parse_size("--size", "640x480", 65536, 1 << 28);
  EXPECT_EQ(size.width, 640);
  EXPECT_EQ(size.height, 480);
  EXPECT_EQ(parse_size("--size", "1X65536", 65536, 1 << 28).height, 65536);
  EXPECT_EQ(parse_size("--size", "640", 65536, 1 << 28).width, 640);
  EXPECT_EQ(parse_size("--size", "640", 65536, 1 << 28).height, 640);
  EXPECT_EQ(parse_size("--size", "16384x16384", 65536, 1 << 28).width, 16384);
  EXPECT_TRUE(fails([] { parse_size("--size", "16384x16385", 65536, 1 << 28); }, "pixels", ErrorCode::usage));
  for (const char* const text : {"", "x", "640x", "x480", "0", "65537", "640.5", "-640", "640 x480", "+1x1",
                                 "1e2x5", "6.5x5", "99999999999x1"})
    EXPECT_TRUE(fails([&] { parse_size("--size", text, 65536, 1 << 28); }, "--size", ErrorCode::usage))
        << text;
}

TEST(Parse, IntegersAreWholeAndInRange) {
  EXPECT_EQ(parse_int("--depth", "64", 1, 64), 64);
  EXPECT_EQ(parse_int("--depth", "010", 1, 64), 10);  // decimal, not octal
  for (const char* const text : {"", " 5", "5 ", "0x5", "65", "0", "5.0", "2147483648"})
    EXPECT_TRUE(fails([&] { parse_int("--depth", text, 1, 64); }, "--depth", ErrorCode::usage)) << text;
}

TEST(Parse, RealsAreFiniteAndInRange) {
  EXPECT_EQ(parse_real("--min-weight", "0.5", 0, 1), 0.5);
  EXPECT_EQ(parse_real("--min-weight", "1e-3", 0, 1), 1e-3);
  for (const char* const text : {"", "nan", "inf", "-0.1", "1.0001", "0,5", "1e999"})
    EXPECT_TRUE(fails([&] { parse_real("--min-weight", text, 0, 1); }, "--min-weight", ErrorCode::usage))
        << text;
}

TEST(Parse, GammaIsANameOrANumber) {
  EXPECT_TRUE(parse_gamma("--gamma", "srgb").srgb);
  EXPECT_FALSE(parse_gamma("--gamma", "2.2").srgb);
  EXPECT_EQ(parse_gamma("--gamma", "1").gamma, 1);
  for (const char* const text : {"", "sRGB ", "0", "-1", "nan", "1000"})
    EXPECT_TRUE(fails([&] { parse_gamma("--gamma", text); }, "srgb", ErrorCode::usage)) << text;
}

TEST(Parse, ListsHoldEachNameOnce) {
  static constexpr std::array<std::string_view, 3> kNames = {"depth", "normal", "cost"};
  EXPECT_EQ(parse_list("--aov", "cost,depth,cost", kNames), (std::vector<std::string>{"cost", "depth"}));
  for (const char* const text : {"", ",", "depth,", ",depth", "depth,,cost", "depth cost", "Depth"})
    EXPECT_TRUE(fails([&] { parse_list("--aov", text, kNames); }, "normal", ErrorCode::usage)) << text;
}

TEST(Parse, BytesHaveAUnitAndALimit) {
  EXPECT_EQ(parse_bytes("--cache-size", "0"), 0u);
  EXPECT_EQ(parse_bytes("--cache-size", "4096"), 4096u);
  EXPECT_EQ(parse_bytes("--cache-size", "3K"), 3072u);
  EXPECT_EQ(parse_bytes("--cache-size", "500M"), std::uint64_t{500} << 20);
  EXPECT_EQ(parse_bytes("--cache-size", "17179869183G"), std::uint64_t{17179869183} << 30);
  EXPECT_EQ(parse_bytes("--memory", "100m"), std::uint64_t{100} << 20);
  EXPECT_EQ(parse_bytes("--memory", "1.5G"), std::uint64_t{1536} << 20);
  EXPECT_EQ(parse_bytes("--memory", "0.5k"), 512u);
  EXPECT_EQ(parse_bytes("--memory", "2t"), std::uint64_t{2} << 40);
  for (const char* text :
       {"", "K", "-1", "-1G", "4 G", "4GB", "1.5.5G", ".", ".G", "1e3", "+4", "nan", "inf", "17179869184G",
        "18446744073709551616", "16777216T", "99999999999999999999.5", "x"})
    EXPECT_TRUE(fails([&] { parse_bytes("--cache-size", text); }, "--cache-size", ErrorCode::usage)) << text;
}

// Text of any kind is a value or a usage error, never anything else.
TEST(Parse, AnyTextIsAValueOrAUsageError) {
  const unsigned seed = 20240611;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::string letters = "0123456789xX.,-+eE nias";
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (std::size_t n = random() % 12; n > 0; --n) text += letters[random() % letters.size()];
    try {
      const Size size = parse_size("--size", text, 1000, 1 << 18);
      EXPECT_TRUE(size.width >= 1 && size.height >= 1 && size.width * size.height <= 1 << 18) << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage) << text;
    }
  }
}

}  // namespace
}  // namespace kdray::cli
