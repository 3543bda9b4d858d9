#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "scene/import/load.h"
#include "scene/model/check_scene.h"
#include "scene/pictures.h"
#include "scene/scratch.h"

namespace kdray::scene {
namespace {

using test::refusal;
using test::ScratchFolder;

Scene read(const std::string& text) {
  Scene scene = read_ply(text, "a.ply");
  check_scene(scene);
  return scene;
}

std::string refused(const std::string& text) {
  return refusal([&] { read_ply(text, "a.ply"); });
}

#define EXPECT_SAYS(message, part) EXPECT_NE((message).find(part), std::string::npos) << (message)

const std::string kVertex = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 2\nproperty list uchar int vertex_indices\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kAscii = "ply\nformat ascii 1.0\n";
const std::string kEnd = "end_header\n";

// Binary values in either byte order.
class Bytes {
 public:
  explicit Bytes(bool big = false) : swap_(big == (std::endian::native == std::endian::little)) {}
  template <class T>
  Bytes& add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (swap_) std::reverse(raw, raw + sizeof(T));
    bytes_.append(raw, sizeof(T));
    return *this;
  }
  template <class T>
  Bytes& all(const std::vector<T>& values) {
    for (const T v : values) add(v);
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  bool swap_;
  std::string bytes_;
};

std::string binary_header(bool big, const std::string& elements) {
  return std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + elements + kEnd;
}

TEST(Ply, ReadsAscii) {
  const Scene s =
      read(kAscii + "comment made by hand\n" + kVertex + kFaces + kEnd + kSquare + "3 0 1 2\n3 0 2 3\n");
  ASSERT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(s.vertices[2], dvec3(1, 1, 0));
  EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_EQ(s.triangles[1].number, 1u);
  EXPECT_EQ(s.triangles[1].normal[0], kNone);
  EXPECT_EQ(s.materials.size(), 1u);
  EXPECT_TRUE(s.warnings.empty());
}

TEST(Ply, ReadsBothByteOrders) {
  for (const bool big : {false, true}) {
    Bytes data(big);
    data.all<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f});
    data.add<std::uint8_t>(3).all<std::int32_t>({0, 1, 2}).add<std::uint8_t>(3).all<std::int32_t>({0, 2, 3});
    const Scene s = read(binary_header(big, kVertex + kFaces) + data.str());
    ASSERT_EQ(s.triangles.size(), 2u);
    EXPECT_EQ(s.vertices[3], dvec3(0, 1, 0.5));
    EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{0, 2, 3}));
  }
}

// Every scalar type as a coordinate, a list's length and a list's entries; other elements and properties
// between.
TEST(Ply, ReadsAllTypesAndSkipsTheRest) {
  const std::string header =
      binary_header(false,
                    "element junk 2\nproperty list short double values\nproperty ushort n\n"
                    "element vertex 3\nproperty uchar quality\nproperty double x\nproperty short y\nproperty "
                    "list uchar uint "
                    "neighbours\nproperty char z\n"
                    "element face 1\nproperty int flags\nproperty list uint ushort vertex_index\nproperty "
                    "list int8 float32 uv\n");
  Bytes data;
  data.add<std::int16_t>(2).all<double>({1, 2}).add<std::uint16_t>(7);
  data.add<std::int16_t>(0).add<std::uint16_t>(8);
  for (int i = 0; i < 3; ++i) {
    data.add<std::uint8_t>(9).add<double>(i + 0.25).add<std::int16_t>(static_cast<std::int16_t>(-i));
    data.add<std::uint8_t>(1).add<std::uint32_t>(5).add<std::int8_t>(static_cast<std::int8_t>(i * i - 1));
  }
  data.add<std::int32_t>(1).add<std::uint32_t>(3).all<std::uint16_t>({2, 1, 0});
  data.add<std::int8_t>(2).all<float>({0.5f, 0.5f});
  const Scene s = read(header + data.str());
  ASSERT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.triangles[0].vertex, (std::array<std::uint32_t, 3>{2, 1, 0}));
  EXPECT_EQ(s.vertices[2], dvec3(2.25, -2, 3));
  ASSERT_FALSE(s.warnings.empty());
  for (const std::string& what : s.warnings) EXPECT_SAYS(what, "left out");
}

TEST(Ply, TakesFacesBeforeVertices) {
  const std::string polygon = "element face 2\nproperty list uchar int vertex_indices\n";
  const Scene s = read(kAscii + polygon + kVertex + kEnd + "4 0 1 2 3\n3 2 1 0\n" + kSquare);
  ASSERT_EQ(s.triangles.size(), 3u);
  EXPECT_EQ(s.triangles[2].vertex, (std::array<std::uint32_t, 3>{2, 1, 0}));
  EXPECT_EQ(s.triangles[2].number, 2u);
}

// An arrow head, which a fan from its first corner would overlap.
TEST(Ply, CutsConcavePolygons) {
  const Scene s = read(kAscii + kVertex + "element face 1\nproperty list uchar int vertex_indices\n" + kEnd +
                       "-1 -1 0\n0 0 0\n1 -1 0\n0 2 0\n4 0 1 2 3\n");
  ASSERT_EQ(s.triangles.size(), 2u);
  double area = 0;
  for (const Triangle& t : s.triangles) {
    const dvec3 a = s.vertices[t.vertex[0]];
    area += glm::cross(s.vertices[t.vertex[1]] - a, s.vertices[t.vertex[2]] - a).z / 2;
  }
  EXPECT_DOUBLE_EQ(area, 2);
}

TEST(Ply, ReadsStripsWithRestarts) {
  const std::string header = kVertex + "element tristrips 1\nproperty list int int vertex_indices\n";
  const Scene s = read(kAscii + header + kEnd + kSquare + "9 0 1 3 2 -1 0 1 2 3\n");
  ASSERT_EQ(s.triangles.size(), 4u);
  EXPECT_EQ(s.triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 3}));
  EXPECT_EQ(s.triangles[1].vertex, (std::array<std::uint32_t, 3>{3, 1, 2}));  // turned over, so the same side
  EXPECT_EQ(s.triangles[2].vertex, (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(s.triangles[3].vertex, (std::array<std::uint32_t, 3>{2, 1, 3}));
}

TEST(Ply, SmoothsWithVertexNormals) {
  const std::string vertex =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty "
      "float "
      "ny\nproperty float nz\nelement face 1\nproperty list uchar int vertex_indices\n";
  const Scene s = read(kAscii + vertex + kEnd + "0 0 0 0 0 2\n1 0 0 0 3 4\n0 1 0 1 0 0\n3 0 1 2\n");
  ASSERT_EQ(s.normals.size(), 3u);
  EXPECT_EQ(s.triangles[0].normal, s.triangles[0].vertex);
  EXPECT_FLOAT_EQ(s.normals[1].y, 0.6f);
  EXPECT_FLOAT_EQ(s.normals[0].z, 1);
  const Scene flat = read(kAscii + vertex + kEnd + "0 0 0 0 0 2\n1 0 0 0 0 0\n0 1 0 1 0 0\n3 0 1 2\n");
  EXPECT_EQ(flat.triangles[0].normal[0], kNone);
  ASSERT_EQ(flat.warnings.size(), 1u);
  EXPECT_SAYS(flat.warnings[0], "1 triangles have a corner normal without a direction");
}

TEST(Ply, WarnsOfWhatItLeavesOut) {
  const std::string header =
      kAscii +
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\nelement face 3\nproperty list uchar int vertex_indices\n" +
      kEnd;
  const Scene s = read(header + "0 0 0 1\n1 0 0 1\n1 1 0 1\n2 0 1\n0\n3 0 1 2\nmore\n");
  EXPECT_EQ(s.triangles.size(), 1u);
  ASSERT_EQ(s.warnings.size(), 3u);
  EXPECT_SAYS(s.warnings[0], "1 property of 'vertex' is left out: red");
  EXPECT_SAYS(s.warnings[1], "more data after the last element");
  EXPECT_SAYS(s.warnings[2], "2 faces with fewer than 3 corners");
}

// The line end of the first line decides where binary data begin: a line feed may be data.
TEST(Ply, FindsTheDataAfterEveryLineEnd) {
  const std::string vertex =
      "element vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\nproperty list "
      "uchar "
      "uchar vertex_indices\n";
  const std::string data = {10, 13, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2};
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string header = binary_header(false, vertex);
    for (std::size_t at = 0; (at = header.find('\n', at)) != std::string::npos; at += end.size()) {
      header.replace(at, 1, end);
    }
    const Scene s = read(header + data);
    EXPECT_EQ(s.vertices[0], dvec3(10, 13, 0));
    EXPECT_EQ(s.triangles.size(), 1u);
  }
}

TEST(Ply, RefusesHeadersWithTheirLine) {
  EXPECT_SAYS(refused(""), "a.ply:1: not a PLY file");
  EXPECT_SAYS(refused("solid\n"), "a.ply:1: not a PLY file");
  EXPECT_SAYS(refused("ply\nformat text 1.0\n"), "a.ply:2: expected ascii, binary_little_endian");
  EXPECT_SAYS(refused("ply\nformat ascii 2.0\n"), "a.ply:2: expected the version 1.0");
  EXPECT_SAYS(refused("ply\nend_header\n"), "a.ply:2: the header has no 'format' line");
  EXPECT_SAYS(refused(kAscii + "element vertex -1\n"), "a.ply:3: expected an element's name");
  EXPECT_SAYS(refused(kAscii + "property float x\n"), "a.ply:3: a property before the first element");
  EXPECT_SAYS(refused(kAscii + "element vertex 1\nproperty long x\n"), "a.ply:4: expected a type");
  EXPECT_SAYS(refused(kAscii + "element face 1\nproperty list float int i\n"),
              "a.ply:4: the length of a list");
  EXPECT_SAYS(refused(kAscii + kVertex + "element vertex 4\n"), "a.ply:7: a second element 'vertex'");
  EXPECT_SAYS(refused(kAscii + "element vertex 1\nproperty float x\nproperty float y\n" + kEnd + "0 0\n"),
              "a.ply:3: element 'vertex' has no property 'z'");
  EXPECT_SAYS(refused(kAscii + "element face 1\nproperty uchar n\n" + kEnd + "0\n"),
              "a.ply:3: element 'face' has no list 'vertex_indices'");
  EXPECT_SAYS(refused(kAscii + "rubbish\n"), "a.ply:3: expected format, element, property");
  EXPECT_SAYS(refused(kAscii + kVertex), "without 'end_header'");
}

TEST(Ply, RefusesDataWithTheirPlace) {
  const std::string header = kAscii + kVertex + kFaces + kEnd;
  EXPECT_SAYS(refused(header + kSquare + "3 0 1 2\n3 0 2 4\n"),
              "a.ply:15: element 'face' 1: there is no vertex 4 (the file has 4)");
  EXPECT_SAYS(refused(header + kSquare + "3 0 1 -2\n3 0 2 3\n"),
              "a.ply:14: element 'face' 0: there is no vertex -2");
  EXPECT_SAYS(refused(header + "0 0 0\n1 x 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"),
              "a.ply:11: element 'vertex' 1: expected a number, found 'x'");
  EXPECT_SAYS(refused(header + kSquare + "3 0 1 2\n3 0 2"),
              "a list of 3 entries, but the file ends before that");
  EXPECT_SAYS(refused(header + kSquare + "-3 0 1 2\n3 0 2 3"),
              "a.ply:14: element 'face' 0: a list of -3 entries");
  EXPECT_SAYS(refused(header + kSquare + "1e9 0 1 2\n3 0 2 3"), "expected a whole number, found '1e9'");

  const std::string binary = binary_header(false, kVertex + kFaces);
  Bytes far;
  far.all<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  far.add<std::uint8_t>(3).all<std::int32_t>({0, 1, 2}).add<std::uint8_t>(3).all<std::int32_t>({0, 1, -1});
  EXPECT_SAYS(refused(binary + far.str()), "element 'face' 1, byte ");
  EXPECT_SAYS(refused(binary + far.str()), "there is no vertex -1 (the file has 4)");
}

// A count is no reason to allocate.
TEST(Ply, DoesNotBelieveCounts) {
  const std::string many =
      "element vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_SAYS(refused(kAscii + many + kEnd + kSquare), "a.ply:3: element 'vertex' says 4000000000 rows");
  EXPECT_SAYS(refused(binary_header(true, many) + kSquare), "a.ply:3: element 'vertex' says 4000000000 rows");
  EXPECT_SAYS(refused(kAscii + "element vertex 99999999999\nproperty float x\n" + kEnd),
              "more than 2^32 rows");
  const std::string list = kVertex + "element face 1\nproperty list uint int vertex_indices\n";
  Bytes data;
  data.all<float>(std::vector<float>(12)).add<std::uint32_t>(0xfffffff0u).all<std::int32_t>({0, 1, 2});
  EXPECT_SAYS(refused(binary_header(false, list) + data.str()), "the file ends too soon");
  // Elements without properties take no bytes, however many there are.
  EXPECT_EQ(
      read(kAscii + "element nothing 18446744073709551615\n" + kVertex + kEnd + kSquare).vertices.size(), 4u);
}

TEST(Ply, TellsOfWhatItLeavesOut) {
  const Scene s = read_ply(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float confidence\nproperty uchar quality\nelement edge 2\nproperty int from\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty int flags\nend_header\n"
      "0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n0\n1\n3 0 1 2 7\n",
      "a.ply");
  EXPECT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.warnings,
            (std::vector<std::string>{"a.ply: 2 properties of 'vertex' are left out: confidence, quality",
                                      "a.ply: 2 rows of element 'edge' are left out",
                                      "a.ply: 1 property of 'face' is left out: flags"}));
}

std::string text_header(const std::string& comments, const std::string& of_vertex,
                        const std::string& of_face) {
  return kAscii + comments + kVertex + of_vertex + kFaces + of_face + kEnd;
}
std::string binary_header_of(const std::string& comments, const std::string& of_vertex,
                             const std::string& of_face) {
  return binary_header(false, comments + kVertex + of_vertex + kFaces + of_face);
}

TEST(Ply, LeavesOutWhatIsNotFinite) {
  const std::string numbers = "0 0 0 0 0 1\n1 0 0 nan 0 1\n1 1 0 0 0 1\nnan 1 0 0 0 1\n";
  const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
  const Scene text = read(text_header("", normals, "") + numbers + "3 0 1 2\n4 0 1 2 3\n");
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Bytes bytes;
  bytes.all<float>({0, 0, 0, 0, 0, 1, 1, 0, 0, kNan, 0, 1, 1, 1, 0, 0, 0, 1, kNan, 1, 0, 0, 0, 1});
  bytes.add<std::uint8_t>(3).all<std::int32_t>({0, 1, 2}).add<std::uint8_t>(4).all<std::int32_t>(
      {0, 1, 2, 3});
  const Scene binary = read(binary_header_of("", normals, "") + bytes.str());
  for (const Scene* s : {&text, &binary}) {
    ASSERT_EQ(s->triangles.size(), 3u);
    EXPECT_EQ(s->triangles[0].vertex, (std::array<std::uint32_t, 3>{0, 1, 2}));
    EXPECT_EQ(s->triangles[0].normal[0], kNone);
    for (const std::size_t bad : {1, 2})
      EXPECT_EQ(s->triangles[bad].vertex, (std::array<std::uint32_t, 3>{3, 3, 3}));
    ASSERT_EQ(s->warnings.size(), 2u);
    EXPECT_SAYS(s->warnings[0],
                "a.ply: element 'vertex' 3: 1 vertices are not finite (this is the first): the 2 triangles");
    EXPECT_SAYS(s->warnings[1], "without a direction");
  }
}

std::array<std::uint32_t, 3> color_at(const Scene& s, std::size_t triangle, std::size_t k) {
  const auto& corner = s.texturing.colors.at(triangle).c[k];
  return {corner[0] & 0xffff, corner[0] >> 16, corner[1] & 0xffff};
}

TEST(Ply, ReadsColoursOfVerticesUnderAllNamesAndOfFaces) {
  using Rgb = std::array<std::uint32_t, 3>;
  const std::string corners = "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 0 0 0\n";
  const Scene short_names =
      read(text_header("", "property uchar r\nproperty uchar g\nproperty uchar b\n", "") + corners +
           "3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(color_at(short_names, 0, 1), (Rgb{0, 65535, 0}));
  EXPECT_TRUE(short_names.warnings.empty());
  const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const Scene faces = read(text_header("", "", rgb) + kSquare + "3 0 1 2 255 0 0\n4 0 1 2 3 0 0 255\n");
  ASSERT_EQ(faces.triangles.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(color_at(faces, 0, k), (Rgb{65535, 0, 0}));
  for (const std::size_t t : {1, 2}) EXPECT_EQ(color_at(faces, t, 2), (Rgb{0, 0, 65535}));
  EXPECT_EQ(faces.texturing.material_maps.at(faces.materials[0].maps).colored, 1u);
  EXPECT_TRUE(faces.warnings.empty());
  // Those of vertices say more.
  const Scene both = read(text_header("", rgb, rgb) + corners + "3 0 1 2 9 9 9\n3 0 2 3 9 9 9\n");
  EXPECT_EQ(color_at(both, 0, 0), (Rgb{65535, 0, 0}));
  ASSERT_EQ(both.warnings.size(), 1u);
  EXPECT_SAYS(both.warnings[0], "3 properties of 'face' are left out: red, green, blue");
}

// The corners' places on the picture, from its upper left corner, as they come to the device.
void expect_square_on_picture(const Scene& s) {
  EXPECT_TRUE(s.warnings.empty()) << s.warnings[0];
  ASSERT_EQ(s.texturing.pictures.size(), 1u);
  const MaterialMaps& maps = s.texturing.material_maps.at(s.materials.at(s.triangles.at(0).material).maps);
  ASSERT_EQ(s.texturing.textures.at(maps.base).picture, 0u);
  ASSERT_EQ(s.texturing.texcoords[0].size(), s.triangles.size());
  for (std::size_t i = 0; i < s.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const dvec3& at = s.vertices[s.triangles[i].vertex[k]];
      EXPECT_EQ(s.texturing.texcoords[0][i].uv[k][0], at.x);
      EXPECT_EQ(s.texturing.texcoords[0][i].uv[k][1], 1 - at.y);
    }
}

TEST(Ply, LaysOnPicturesByTextureCoordinates) {
  const ScratchFolder folder;
  folder.write("A b.png", test::four_colors());
  const auto read_beside = [&](const std::string& text) {
    Scene s = read_ply(text, folder / "a.ply");
    check_scene(s);
    return s;
  };
  const std::string comment = "comment TextureFile a b.png\n", list = "property list uchar float texcoord\n";
  expect_square_on_picture(read_beside(text_header(comment, "", list) + kSquare +
                                       "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n"));
  expect_square_on_picture(read_beside(text_header(comment, "", list) + kSquare +
                                       "4 3 0 1 2 8 0 1 0 0 1 0 1 1\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n"));
  for (const std::string names : {"texture_u texture_v", "s t", "u v"}) {
    const std::string u = names.substr(0, names.find(' ')), v = names.substr(names.find(' ') + 1);
    const std::string of_vertex = "property float " + u + "\nproperty float " + v + "\n";
    expect_square_on_picture(read_beside(text_header(comment, of_vertex, "") +
                                         "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n3 0 2 3\n"));
    Bytes bytes;
    bytes.all<float>({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 1, 0, 0, 1});
    for (const auto& face : {std::vector<std::int32_t>{0, 1, 2}, {0, 2, 3}})
      bytes.add<std::uint8_t>(3).all(face);
    expect_square_on_picture(read_beside(binary_header_of(comment, of_vertex, "") + bytes.str()));
  }
}

TEST(Ply, ChoosesAmongPicturesAndTellsOfWrongOnes) {
  const ScratchFolder folder;
  folder.write("a.png", test::four_colors());
  folder.write("b.png", test::png(1, 1, 3, {1, 2, 3}));
  const std::string two = "comment TextureFile a.png\ncomment TextureFile \"b.png\"\n";
  const std::string of_face = "property list uchar float texcoord\nproperty int texnumber\n";
  const Scene s =
      read_ply(text_header(two, "", of_face) + kSquare + "3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 4 0 0 nan 0 7\n",
               folder / "a.ply");
  check_scene(s);
  ASSERT_EQ(s.texturing.pictures.size(), 2u);
  EXPECT_EQ(
      s.texturing
          .pictures[s.texturing
                        .textures[s.texturing.material_maps[s.materials[s.triangles[0].material].maps].base]
                        .picture]
          ->width,
      1u);
  EXPECT_EQ(s.triangles[1].material, 0u);
  ASSERT_EQ(s.warnings.size(), 2u);
  EXPECT_SAYS(s.warnings[0], "the texture coordinates of 1 faces are not two for each corner");
  EXPECT_SAYS(s.warnings[1], "the texnumber of 1 faces is that of no TextureFile");
  const Scene none =
      read_ply(text_header("comment TextureFile ../c.png\n", "", "property list uchar float texcoord\n") +
                   kSquare + "3 0 1 2 6 0 0 1 0 1 nan\n3 0 2 3 0\n",
               folder / "a.ply");
  check_scene(none);
  ASSERT_EQ(none.warnings.size(), 2u);
  EXPECT_SAYS(none.warnings[0], "1 texture coordinates are not finite");
  EXPECT_SAYS(none.warnings[1], "no picture '../c.png'; put it beside the scene; --asset-root DIR allows");
  const Scene bare =
      read_ply(text_header(two, "", "property int texnumber\n") + kSquare + "3 0 1 2 1\n3 0 2 3 0\n",
               folder / "a.ply");
  check_scene(bare);
  ASSERT_EQ(bare.warnings.size(), 1u);
  EXPECT_SAYS(bare.warnings[0], "there are no texture coordinates");
}

TEST(Ply, TakesTheFirstOfPropertiesOfOneName) {
  const Scene s = read(text_header("", "property float x\n", "") +
                       "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n3 0 1 2\n3 0 2 3\n");
  EXPECT_EQ(s.vertices[1], dvec3(1, 0, 0));
  ASSERT_EQ(s.warnings.size(), 1u);
  EXPECT_SAYS(s.warnings[0], "1 property of 'vertex' is left out: x (its second)");
}

TEST(Ply, SaysThatPointsHaveNoSurface) {
  const Scene cloud = read(kAscii + kVertex + kEnd + kSquare);
  ASSERT_EQ(cloud.warnings.size(), 1u);
  EXPECT_SAYS(cloud.warnings[0], "a.ply: it is a point cloud: kdray shows surfaces; make a mesh of it first");
  const Scene splats =
      read(kAscii + kVertex + "property float f_dc_0\n" + kEnd + "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n");
  ASSERT_EQ(splats.warnings.size(), 2u);
  EXPECT_SAYS(splats.warnings[0], "it holds Gaussian splats: kdray shows surfaces");
}

}  // namespace
}  // namespace kdray::scene
