// What    How many primitives each generator writes at several sizes, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "nff_lines.h"

namespace kdray::generate {
namespace {

struct Counts {
  std::size_t spheres, cones, polygons, patches, lights, surfaces;  // surfaces: different ones
};

struct Case {
  const char* name;
  std::vector<int> sizes;
  Counts (*expected)(std::size_t size);
};

std::size_t power(std::size_t base, std::size_t exponent) {
  return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

const Case kCases[] = {
    {"balls",
     {0, 1, 2, 3, 4},
     [](std::size_t n) { return Counts{(power(9, n + 1) - 1) / 8, 0, 1, 0, 3, 2}; }},
    {"mount", {0, 1, 2, 5, 6, 8}, [](std::size_t n) { return Counts{4, 0, 2 * power(4, n), 0, 1, 2}; }},
    {"rings",
     {1, 2, 3, 7},
     [](std::size_t n) {
       const std::size_t each = 5 * n * (n + 1) * (2 * n + 1);
       return Counts{each, each, 1, 0, 3, 7};
     }},
    {"teapot", {2, 3, 6, 12}, [](std::size_t n) { return Counts{0, 0, n * n, 64 * n * n - 8 * n, 2, 3}; }},
    {"tetra", {1, 2, 3, 6}, [](std::size_t n) { return Counts{0, 0, power(4, n), 0, 1, 1}; }},
    {"tree",
     {0, 1, 2, 3, 11},
     [](std::size_t n) { return Counts{power(2, n + 1) - 1, power(2, n + 1) - 1, 1, 0, 7, 2}; }},
    {"lattice",
     {1, 2, 3, 5, 12},
     [](std::size_t n) { return Counts{power(n + 1, 3), 3 * n * power(n + 1, 2), 0, 0, 6, 4}; }},
    {"shells", {1, 2, 3, 4, 5}, [](std::size_t n) { return Counts{180 * power(2, n) + 1, 0, 0, 0, 1, 1}; }},
    {"sombrero",
     {1, 2, 3},
     [](std::size_t n) { return Counts{0, 0, 2 * power(16 * power(2, n) - 1, 2), 0, 1, 1}; }},
    {"jacks",
     {1, 2, 3, 4},
     [](std::size_t n) {
       const std::size_t jacks = (power(8, n) - 1) / 7;
       return Counts{6 * jacks, 3 * jacks, 0, 0, 1, 1};
     }},
};

TEST(Counts, AreTheClosedForms) {
  for (const Case& c : kCases)
    for (const int size : c.sizes) {
      SCOPED_TRACE(std::string(c.name) + " " + std::to_string(size));
      const Counts expected = c.expected(static_cast<std::size_t>(size));
      const test::Nff nff = test::parse_nff(test::generated(c.name, size));
      EXPECT_EQ(nff.spheres.size(), expected.spheres);
      EXPECT_EQ(nff.cones.size(), expected.cones);
      EXPECT_EQ(nff.polygons.size(), expected.polygons);
      EXPECT_EQ(nff.patches.size(), expected.patches);
      EXPECT_EQ(static_cast<std::size_t>(nff.lights), expected.lights);
      EXPECT_EQ(nff.surfaces.size(), expected.surfaces);
    }
}

// The largest size of each is the last whose file has fewer than 10^8 primitives.
TEST(Counts, LargestSizesFollowTheirRule) {
  constexpr std::size_t limit = 100'000'000;
  const auto largest = [](std::string_view name) {
    for (const Generator& g : generators())
      if (g.name == name) return static_cast<std::size_t>(g.max_size);
    return std::size_t{0};
  };
  for (const Case& c : kCases) {
    const auto total = [&](std::size_t size) {
      const Counts n = c.expected(size);
      return n.spheres + n.cones + n.polygons + n.patches;
    };
    EXPECT_LT(total(largest(c.name)), limit) << c.name;
    EXPECT_GE(total(largest(c.name) + 1), limit) << c.name;
  }
  EXPECT_LT(146 * power(largest("gears"), 3) + 1, limit);
  EXPECT_GE(146 * power(largest("gears") + 1, 3) + 1, limit);
}

// The teapot of one quad a patch has more quads that shrink to a triangle, but no more that vanish.
TEST(Counts, TeapotOfSizeOne) {
  const test::Nff nff = test::parse_nff(test::generated("teapot", 1));
  EXPECT_EQ(nff.patches.size(), 56u);
  EXPECT_EQ(nff.polygons.size(), 1u);
}

TEST(Counts, Gears) {
  for (const int size : {1, 2, 3, 4}) {
    const test::Nff nff = test::parse_nff(test::generated("gears", size));
    std::size_t faces = 0, sides = 0;
    for (const test::NffPolygon& p : nff.polygons) (p.vertices.size() == 144 ? faces : sides) += 1;
    const std::size_t gears = power(static_cast<std::size_t>(size), 3);
    EXPECT_EQ(faces, 2 * gears);
    EXPECT_EQ(sides, 144 * gears + 1);
    EXPECT_EQ(nff.lights, 5);
    EXPECT_TRUE(nff.spheres.empty() && nff.cones.empty() && nff.patches.empty());
  }
}

}  // namespace
}  // namespace kdray::generate
