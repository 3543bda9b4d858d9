// What    The registry: names, sizes, refusals; and that the text depends on nothing but name and size.
#include "scene/generate/generate.h"

#include <gtest/gtest.h>

#include <locale>
#include <set>
#include <sstream>

#include "base/error.h"
#include "nff_lines.h"

namespace kdray::generate {
namespace {

using test::generated;

std::string refusal(std::string_view name, int size) {
  try {
    generated(name, size);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    return e.what();
  }
  ADD_FAILURE() << name << " at size " << size << " was accepted";
  return "";
}

TEST(Generate, ListsElevenScenesEachOnce) {
  std::set<std::string_view> names;
  for (const Generator& g : generators()) {
    EXPECT_TRUE(names.insert(g.name).second) << g.name;
    EXPECT_FALSE(g.description.empty());
    EXPECT_LE(g.min_size, g.default_size);
    EXPECT_LE(g.default_size, g.max_size);
  }
  EXPECT_EQ(names.size(), 11u);
}

TEST(Generate, RefusesAnUnknownNameAndNamesWhatThereIs) {
  const std::string message = refusal("ball", 4);
  EXPECT_NE(message.find("'ball'"), std::string::npos);
  for (const Generator& g : generators()) EXPECT_NE(message.find(g.name), std::string::npos) << g.name;
}

TEST(Generate, RefusesSizesOutsideTheRange) {
  for (const Generator& g : generators()) {
    for (const int size : {g.min_size - 1, g.max_size + 1, -1'000'000, 1'000'000'000})
      EXPECT_NE(refusal(g.name, size).find(std::to_string(g.max_size)), std::string::npos) << g.name;
  }
}

TEST(Generate, WritesTheSmallestSizeOfEach) {
  for (const Generator& g : generators()) {
    const auto lines = test::nff_lines(generated(g.name, g.min_size));
    EXPECT_GT(lines.size(), 10u) << g.name;
    EXPECT_EQ(lines[0][0], "b") << g.name;
    EXPECT_EQ(lines[1][0], "v") << g.name;
  }
}

TEST(Generate, WritesTheSameTextTwice) {
  EXPECT_EQ(generated("mount", 3), generated("mount", 3));
  EXPECT_NE(generated("mount", 3), generated("mount", 2));
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  std::string do_grouping() const override { return "\3"; }
  char do_thousands_sep() const override { return '.'; }
};

TEST(Generate, DoesNotFollowTheLocale) {
  const std::string plain = generated("gears", 1);
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  const std::string foreign = generated("gears", 1);
  std::locale::global(before);
  EXPECT_EQ(foreign, plain);
}

TEST(Generate, WritesNumbersAFloatKeepsApart) {
  // Neighbouring vertices at the largest sizes differ in the seventh digit: six, as SPD prints, would merge
  // them.
  const test::Nff nff = test::parse_nff(generated("tetra", 8));
  for (const test::NffPolygon& p : nff.polygons) {
    ASSERT_EQ(p.vertices.size(), 3u);
    EXPECT_NEAR(glm::distance(p.vertices[0], p.vertices[1]), std::sqrt(8.0) / 128, 1e-8);
  }
}

}  // namespace
}  // namespace kdray::generate
