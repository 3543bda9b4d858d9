// What    Colours as the web writes them: names, three and six digits, and what is none of them.
#include "io/image/color.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kdray::image {
namespace {

// IEC 61966-2-1, written anew.
float linear(int code) {
  const double v = code / 255.0;
  return static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

void expect_color(std::string_view text, int red, int green, int blue) {
  const auto color = css_color(text);
  ASSERT_TRUE(color.has_value()) << text;
  EXPECT_FLOAT_EQ(color->x, linear(red)) << text;
  EXPECT_FLOAT_EQ(color->y, linear(green)) << text;
  EXPECT_FLOAT_EQ(color->z, linear(blue)) << text;
}

TEST(CssColor, NamesAndDigitsAreLinearValues) {
  expect_color("white", 255, 255, 255);
  expect_color("black", 0, 0, 0);
  expect_color("aliceblue", 240, 248, 255);   // the first
  expect_color("yellowgreen", 154, 205, 50);  // the last
  expect_color("rebeccapurple", 102, 51, 153);
  expect_color("SkyBlue", 135, 206, 235);
  expect_color("grey", 128, 128, 128);
  expect_color("#fff", 255, 255, 255);
  expect_color("#F80", 255, 136, 0);
  expect_color("#0a141e", 10, 20, 30);
}

TEST(CssColor, EveryNameIsOne) {
  const auto names = css_names();
  EXPECT_EQ(names.size(), 148u);  // of CSS Color Module Level 4
  for (const std::string_view name : names) EXPECT_TRUE(css_color(name).has_value()) << name;
}

TEST(CssColor, OtherTextIsNone) {
  for (const char* const text :
       {"", "#", "#ff", "#ffff", "#fffff", "#fffffff", "#ggg", "#-12", "#+12345", "# fff", "transparent",
        "skyblu", "blue ", " blue", "red:ff0000", "ff0000", "blue:", "sky blue"})
    EXPECT_FALSE(css_color(text).has_value()) << text;
}

}  // namespace
}  // namespace kdray::image
