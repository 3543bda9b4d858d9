#include "scene/import/text_scanner.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <random>
#include <string>

namespace kdray::scene {
namespace {

// Digits with a sign, a point and an exponent now and then, of every length up to a few more than are plain.
std::string random_decimal(std::mt19937& random) {
  const auto digits = [&](unsigned most) {
    std::string text;
    for (unsigned n = random() % (most + 1); n > 0; --n) text += static_cast<char>('0' + random() % 10);
    return text;
  };
  std::string text = random() % 2 ? "-" : "";
  text += digits(11);
  if (random() % 4 != 0) text += "." + digits(12);
  if (random() % 8 == 0) text += "e-" + digits(2);
  return text;
}

TEST(PlainNumber, IsWhatFromCharsReads) {
  std::mt19937 random(11);
  int n_plain = 0;
  for (int i = 0; i < 200000; ++i) {
    const std::string text = random_decimal(random);
    const char* const end = text.data() + text.size();
    double plain = 0, wanted = 0;
    if (read_plain_number(text.data(), end, plain) != end || text.empty()) continue;
    const auto [stop, code] = std::from_chars(text.data(), end, wanted);
    ASSERT_TRUE(stop == end && code == std::errc()) << text;
    ASSERT_EQ(plain, wanted) << text;
    ASSERT_EQ(std::signbit(plain), std::signbit(wanted)) << text;
    ++n_plain;
  }
  EXPECT_GT(n_plain, 100000) << "most are plain";
}

TEST(PlainNumber, LeavesTheOddToFromChars) {
  for (const std::string text : {"", "-", ".", "-.", "+1", "nan", "1e5", "1.5E-3", "9007199254740993",
                                 "0.00000000000000000000", "12345678901234567890"}) {
    double value = 7;
    EXPECT_EQ(read_plain_number(text.data(), text.data() + text.size(), value), nullptr) << text;
    EXPECT_EQ(value, 7) << text;
  }
  for (const std::string text : {"", "-1", "+1", "x", "1234567890123456789"}) {
    std::int64_t value = 7;
    EXPECT_EQ(read_plain_whole(text.data(), text.data() + text.size(), value), nullptr) << text;
    EXPECT_EQ(value, 7) << text;
  }
}

TEST(PlainNumber, EndsWhereTheNumberEnds) {
  const std::string text = "0.25/7 ";
  double number = 0;
  std::int64_t whole = 0;
  EXPECT_EQ(read_plain_number(text.data(), text.data() + text.size(), number), text.data() + 4);
  EXPECT_EQ(number, 0.25);
  EXPECT_EQ(read_plain_whole(text.data() + 5, text.data() + text.size(), whole), text.data() + 6);
  EXPECT_EQ(whole, 7);
  EXPECT_EQ(read_plain_number(text.data(), text.data() + 3, number), text.data() + 3) << "not beyond the end";
  EXPECT_EQ(number, 0.2);
}

}  // namespace
}  // namespace kdray::scene
