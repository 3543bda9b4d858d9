#include "scene/import/text_scanner.h"

#include <limits>

#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;

double read_one(const std::string& text) {
  return TextScanner(text, "t").number("a number");
}

TEST(TextScanner, ReadsEveryFormOfANumber) {
  EXPECT_EQ(read_one("1"), 1.0);
  EXPECT_EQ(read_one("-1.5"), -1.5);
  EXPECT_EQ(read_one("+2.5e-1"), 0.25);
  EXPECT_EQ(read_one(".5"), 0.5);
  EXPECT_EQ(read_one("5."), 5.0);
  EXPECT_EQ(read_one("1E3"), 1000.0);
  EXPECT_EQ(read_one("0.1"), 0.1);
  EXPECT_EQ(read_one("1.7976931348623157e308"), std::numeric_limits<double>::max());
  EXPECT_EQ(read_one("1e-400"), 0.0);
  EXPECT_EQ(read_one("4.9e-324"), std::numeric_limits<double>::denorm_min());
}

TEST(TextScanner, RefusesWhatIsNoFiniteNumber) {
  for (const char* text : {"nan", "-nan", "inf", "-inf", "infinity", "1e999", "-1e999", "1.2.3", "1x", "--1",
                           "+-1", "+", "-", ".", "e5", "0x10", "1,5", "", "#1"}) {
    refusal([&] { read_one(text); });
  }
}

TEST(TextScanner, KnowsItsLineWhateverEndsIt) {
  TextScanner in(
      "\xef\xbb\xbf"
      "a # comment 1 2\n\n  b\r\nc\rd#e\n",
      "t");
  EXPECT_EQ(in.word("a word"), "a");
  EXPECT_EQ(in.line(), 1u);
  EXPECT_EQ(in.word("a word"), "b");
  EXPECT_EQ(in.line(), 3u);
  EXPECT_EQ(in.word("a word"), "c");
  EXPECT_EQ(in.line(), 4u);
  EXPECT_EQ(in.word("a word"), "d");
  EXPECT_EQ(in.line(), 5u);
  EXPECT_TRUE(in.at_end());
  EXPECT_EQ(refusal([&] { in.number("a radius"); }), "t:5: expected a radius, but the file ends here");
}

TEST(TextScanner, ShowsTheWordAtFaultSafely) {
  const std::string text = "\n\x1b[31m" + std::string(100, 'x');
  TextScanner in(text, "t");
  const std::string message = refusal([&] { in.number("a number"); });
  EXPECT_EQ(message, "t:2: expected a number, found '?[31m" + std::string(35, 'x') + "...'");
}

TEST(TextScanner, CountsAreWholeAndFitIn32Bits) {
  EXPECT_EQ(TextScanner("4294967295", "t").count("a count"), 4294967295u);
  for (const char* text : {"4294967296", "-1", "1.0", "1e3", "+1", "x"}) {
    refusal([&] { TextScanner(text, "t").count("a count"); });
  }
}

}  // namespace
}  // namespace kdray::scene
