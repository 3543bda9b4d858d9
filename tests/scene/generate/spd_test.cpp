// What    At SPD's own sizes every line of every scene holds the same entity and the same numbers as the
//         published file, to the six digits that file has.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "nff_lines.h"
#include "scene/import/files.h"
#include "support/data.h"

namespace kdray::generate {
namespace {

// One unit of the sixth digit; and a rotation's rounding noise, which SPD prints and kdray writes as 0.
double tolerance(double published) {
  if (std::abs(published) < 1e-12) return 1e-12;
  return std::pow(10.0, std::floor(std::log10(std::abs(published))) - 5) * 1.0001;
}

bool same_word(const std::string& published, const std::string& ours) {
  char* end = nullptr;
  const double expected = std::strtod(published.c_str(), &end);
  if (*end != '\0') return published == ours;
  const double value = std::strtod(ours.c_str(), &end);
  return *end == '\0' && std::abs(value - expected) <= tolerance(expected);
}

std::string join(const test::Words& words) {
  std::string line;
  for (const std::string& w : words) line += w + ' ';
  return line;
}

class Spd : public testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const Generator& g : generators()) names.emplace_back(g.name);
  return names;
}

int default_size(const std::string& name) {
  for (const Generator& g : generators())
    if (g.name == name) return g.default_size;
  return -1;
}

TEST_P(Spd, EqualsThePublishedFile) {
  const auto file = test::data_path("spd/" + GetParam() + ".nff.gz");
  KDRAY_NEED_DATA(file);
  const auto published = test::nff_lines(scene::read_file(file));
  const auto ours = test::nff_lines(test::generated(GetParam(), default_size(GetParam())));
  ASSERT_EQ(ours.size(), published.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    ASSERT_TRUE(std::ranges::equal(published[i], ours[i], same_word))
        << "line " << i + 1 << ": " << join(published[i]) << "became " << join(ours[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Spd, testing::ValuesIn(names()), [](const auto& param) { return param.param; });

}  // namespace
}  // namespace kdray::generate
