#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <string>
#include <vector>

#include "scene/import/load.h"
#include "scene/model/check_scene.h"
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

// Red, green and blue of a facet in 65535ths.
std::array<std::uint32_t, 3> color_of(const Scene& s, std::size_t facet) {
  const auto& corner = s.texturing.colors.at(facet).c[0];
  return {corner[0] & 0xffff, corner[0] >> 16, corner[1] & 0xffff};
}

void set_attribute(std::string& file, std::size_t facet, std::uint32_t bits) {
  file[84 + 50 * facet + 48] = static_cast<char>(bits & 0xff);
  file[84 + 50 * facet + 49] = static_cast<char>(bits >> 8);
}

TEST(Stl, ReadsColoursOfFacets) {
  EXPECT_TRUE(read(binary("", 3)).texturing.colors.empty());
  using Rgb = std::array<std::uint32_t, 3>;
  const std::uint32_t grey = linear_unit(0.7f), half = linear_unit_of_srgb(16 / 31.0);
  std::string viscam = binary("", 3), materialise = binary(std::string("a COLOR=\xff\x80\0\xff", 12), 3);
  set_attribute(viscam, 1, 0x8000 | 31 << 10 | 16 << 5);
  set_attribute(materialise, 1, 31 | 16 << 5);
  for (const std::size_t plain : {0, 2}) set_attribute(materialise, plain, 0xffff);
  const Scene a = read(viscam), b = read(materialise);
  EXPECT_EQ(color_of(a, 0), (Rgb{grey, grey, grey}));
  EXPECT_EQ(color_of(a, 1), (Rgb{65535, half, 0}));
  EXPECT_EQ(color_of(b, 0), (Rgb{65535, linear_unit_of_srgb(128 / 255.0), 0}));
  EXPECT_EQ(color_of(b, 1), (Rgb{65535, half, 0}));
  for (const Scene* s : {&a, &b}) {
    EXPECT_TRUE(s->warnings.empty());
    EXPECT_EQ(s->texturing.material_maps.at(s->materials[0].maps).colored, 1u);
  }
}

TEST(Stl, ReadsWordsThatAreApartOrMissing) {
  const std::string corners = "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  const Scene apart = read("solid a\nfacet normal 0 0 1\n" + corners + "end loop\nEnd Facet\n" +
                           facet("0 0 1") + "end solid a\nsolid b\n" + facet("0 0 1") + "end solid");
  EXPECT_EQ(apart.triangles.size(), 3u);
  EXPECT_TRUE(apart.warnings.empty());
  const std::string open = "facet normal 0 0 1\n" + corners + "endloop\n";
  const Scene missing = read("solid a\n" + open + open + "endsolid a\n");
  EXPECT_EQ(missing.triangles.size(), 2u);
  ASSERT_EQ(missing.warnings.size(), 1u);
  EXPECT_SAYS(missing.warnings[0], "a.stl:8: 2 statements 'endfacet' are missing");
  EXPECT_EQ(read("solid a\nfacet normal 0 0 1\n" + corners + "endfacet\nendsolid").triangles.size(), 1u);
}

TEST(Stl, TakesAnyNameForASolid) {
  for (const std::string name :
       {"a facet normal of it", "facet", "facet normal 1", "end solid", "outer loop"}) {
    const Scene s = read("solid " + name + "\n" + facet("0 0 1") + "endsolid " + name + "\n");
    EXPECT_EQ(s.triangles.size(), 1u) << name;
    EXPECT_TRUE(s.warnings.empty()) << name;
  }
}

TEST(Stl, CountsFacetsByTheSizeWhereTheHeaderDoesNot) {
  for (const std::string& count : {std::string(4, '\0'), std::string(4, '\xff')}) {
    std::string text = binary("solid by a program", 3);
    text.replace(80, 4, count);
    const Scene s = read(text);
    EXPECT_EQ(s.triangles.size(), 3u);
    ASSERT_EQ(s.warnings.size(), 1u);
    EXPECT_SAYS(s.warnings[0], "by its size it has 3: these are read");
  }
}

TEST(Stl, LeavesOutFacetsThatAreNotFinite) {
  const Scene text =
      read("solid\n" + facet("0 0 1", "0 nan 0") + facet("0 0 1") + facet("0 0 1", "1e999 0 0"));
  EXPECT_EQ(text.triangles.size(), 1u);
  ASSERT_EQ(text.warnings.size(), 1u);
  EXPECT_SAYS(text.warnings[0], "a.stl:2: 2 facets have a coordinate that is not finite");
  std::string bytes = binary("", 3);
  bytes.replace(84 + 50 + 12, 4, std::string("\0\0\xc0\x7f", 4));
  const Scene s = read(bytes);
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{3, 3, 3}));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "a.stl: facet 1: 1 vertices are not finite");
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
  EXPECT_TRUE(none.triangles.empty());
}

TEST(Stl, RefusesTextWithItsLine) {
  EXPECT_SAYS(refused("solid\n" + facet("0 0 1", "0 x 0")), "a.stl:6: expected a vertex of three numbers");
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
  huge.replace(80, 4, "\xfe\xff\xff\xff");
  EXPECT_SAYS(refused(huge), "says 4294967294 facets");
}

}  // namespace
}  // namespace kdray::scene
