#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <string>
#include <vector>

#include "scene/check_scene.h"
#include "scene/importers.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;

Scene read(const std::string& text) {
  Scene scene = read_stl(text, "a.stl");
  check_scene(scene);
  return scene;
}

std::string refused(const std::string& text) {
  return refusal([&] { read_stl(text, "a.stl"); });
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

std::string facet(const std::string& normal, const std::string& last = "0 1 0") {
  return "  facet normal " + normal +
         "\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex " + last +
         "\n    endloop\n  endfacet\n";
}

void append(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

// A binary file of triangles (i, 0, 0), (i + 1, 0, 0), (i, 1, 0).
std::string binary(const std::string& title, std::uint32_t n) {
  std::string bytes = title;
  bytes.resize(80, ' ');
  append(bytes, n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto x = static_cast<float>(i);
    for (const float v : {0.f, 0.f, 0.f, x, 0.f, 0.f, x + 1, 0.f, 0.f, x, 1.f, 0.f}) {
      append(bytes, std::bit_cast<std::uint32_t>(v));
    }
    bytes += std::string(2, '\x7f');
  }
  return bytes;
}

std::string on_one_line(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text;
}

TEST(Stl, ReadsAsciiOnOneLine) {
  const std::string text = "solid a facet of it\n" + facet("0 0 1") + facet("nan -inf 1e999", "0 2.5 0") +
                           "endsolid a facet of it\nsolid b\n" + facet("0 0 0") + "endsolid b";
  const Scene s = read(on_one_line(text)), wanted = read(text);
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.vertices, wanted.vertices);
  EXPECT_EQ(read("solid endsolid").triangles.size(), 0u);
}

TEST(Stl, ReadsAsciiBehindComments) {
  const Scene s = read("# made by hand\n\n  # solid\nsolid a # b\n" + facet("0 0 1") + "endsolid a");
  EXPECT_EQ(s.triangles.size(), 1u);
  EXPECT_SAYS(refused("# nothing else"), "too short");
}

TEST(Stl, SaysThatColoursAreLeftOut) {
  EXPECT_TRUE(read(binary("", 5)).warnings.empty());
  std::string viscam = binary("", 5);
  for (const std::size_t facet : {1u, 3u}) viscam[84 + 50 * facet + 49] = '\x80';
  ASSERT_EQ(read(viscam).warnings.size(), 1u);
  EXPECT_SAYS(read(viscam).warnings[0], "the colours of 2 facets are left out");
  ASSERT_EQ(read(binary("COLOR=....", 5)).warnings.size(), 1u);
}

TEST(Stl, ReadsAscii) {
  const Scene s =
      read("solid a name with facet in it\n" + facet("0 0 1") + facet("nan 1.#IND -inf", "0 2.5 0") +
           "endsolid a name with facet in it\nsolid\n" + facet("0 0 0") + "endsolid");
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.vertices[5], dvec3(0, 2.5, 0));
  EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{3, 4, 5}));
  EXPECT_EQ(s.triangles[2].number, 2u);
  EXPECT_EQ(s.triangles[0].normal[0], kNone);
  EXPECT_EQ(s.materials.size(), 1u);
}

TEST(Stl, ReadsBinaryWhateverItsTitle) {
  for (const std::string title : {"", "solid made by a program", "solid\nfacet normal"}) {
    const Scene s = read(binary(title, 2));
    ASSERT_EQ(s.triangles.size(), 2u);
    EXPECT_EQ(s.vertices[4], dvec3(2, 0, 0));
    EXPECT_TRUE(s.warnings.empty());
  }
  const Scene longer = read(binary("", 2) + "xyz");
  ASSERT_EQ(longer.warnings.size(), 1u);
  EXPECT_SAYS(longer.warnings[0], "3 bytes after the last facet");
}

TEST(Stl, TakesUpperCaseAndEmptySolids) {
  std::string text = "SOLID X\n" + facet("0 0 1") + "ENDSOLID X\n";
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(read(text).triangles.size(), 1u);
  const Scene none = read("solid\nendsolid\n");
  ASSERT_EQ(none.warnings.size(), 1u);
  EXPECT_SAYS(none.warnings[0], "no facets");
}

TEST(Stl, RefusesTextWithItsLine) {
  EXPECT_SAYS(refused("solid\n" + facet("0 0 1", "0 nan 0")), "a.stl:6: expected a vertex of three numbers");
  EXPECT_SAYS(refused("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n"),
              "a.stl:5: expected three lines 'vertex X Y Z'");
  EXPECT_SAYS(refused("solid\nrubbish\n"), "a.stl:2: expected facet or endsolid, found 'rubbish'");
  EXPECT_SAYS(refused("solid\nfacet normal 0 0 1\nouter"), "the file ends here");
}

TEST(Stl, RefusesBytesWithTheirFacet) {
  EXPECT_SAYS(refused("short"), "too short for an STL file");
  std::string cut = binary("", 3);
  cut.resize(cut.size() - 7);
  EXPECT_SAYS(refused(cut), "says 3 facets, for which it is 7 bytes too short");
  std::string huge = binary("", 1);
  huge.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_SAYS(refused(huge), "says 4294967295 facets");
  std::string bad = binary("", 2);
  bad.replace(84 + 50 + 12, 4, std::string("\0\0\xc0\x7f", 4));
  EXPECT_SAYS(refused(bad), "a.stl: facet 1: a coordinate is not finite");
}

}  // namespace
}  // namespace kdray::scene
